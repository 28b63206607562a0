# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The node's subscriptions, in a process of their own, with publishers of every kind."""

import array
import re
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import MOST_UNTIL_ENDED, Handshake, Program
from rclpy.node import Node
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_profile_sensor_data,
)
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from waiting import stays, wait_until

from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.codecs.png import write_png
from lsc_pose_ros.messages.stamps import NANOSECONDS
from lsc_pose_ros.ros.health.stream_warnings import Counters

PROGRAM = Path(__file__).parent / 'inputs_program.py'
RELIABLE = QoSProfile(depth=10)

# Publishes as `ros2 bag play [--delay]` does: at once, or after the wait.
PLAYER = """
import sys
import time

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image

rclpy.init()
node = Node('rosbag2_player')
publisher = node.create_publisher(Image, 'depth/image', 10)
if sys.argv[1] == 'delay':
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    time.sleep(2.0)
while rclpy.ok():
    publisher.publish(Image())
    time.sleep(0.03)
"""
LATCHED = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
FRAME = 33_333_333
START = 1_700_000_000_000_000_000


def stamped(message: Image | CompressedImage | CameraInfo, stamp: int) -> object:
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
    return message


def image(stamp: int, encoding: str = '16UC1') -> Image:
    size = 1 if encoding == 'mono8' else 2
    data = array.array('B', bytes(4 * 3 * size))
    return stamped(Image(height=3, width=4, encoding=encoding, step=4 * size, data=data), stamp)


def pairs_of(program: Program) -> list[tuple[int, int | None]]:
    found = re.findall(r'^pair (\d+) (\d+|None)$', program.output, re.MULTILINE)
    return [(int(depth), None if mask == 'None' else int(mask)) for depth, mask in found]


def counters_of(program: Program) -> Counters:
    lines = re.findall(r'^counters Counters\((.*)\)$', program.output, re.MULTILINE)
    return Counters(**{n: int(v) for n, v in re.findall(r'(\w+)=(\d+)', lines[-1])})


def subscription_of(probe: Node, topic: str) -> QoSProfile | None:
    found = [
        each.qos_profile
        for each in probe.get_subscriptions_info_by_topic(topic)
        if each.node_name == 'pose_node'
    ]
    return found[0] if len(found) == 1 else None


def is_reliable(probe: Node, topic: str, *, wanted: bool) -> bool:
    kinds = {True: QoSReliabilityPolicy.RELIABLE, False: QoSReliabilityPolicy.BEST_EFFORT}

    def right() -> bool:
        profile = subscription_of(probe, topic)
        return profile is not None and profile.reliability == kinds[wanted]

    return wait_until(right)


@pytest.fixture
def listen(start_program: Callable[..., Program]) -> Callable[..., Program]:
    """Start the program with parameters, and wait until it listens."""

    def begin(*words: str) -> Program:
        program = start_program(PROGRAM, *words)
        assert program.prints('listening to'), program.output
        return program

    return begin


class Senders:
    """Publishers of depth, camera info and masks."""

    def __init__(self, probe: Node, qos: QoSProfile = RELIABLE, *, mask: bool = True) -> None:
        self.depth = probe.create_publisher(Image, 'depth/image', qos)
        self.info = probe.create_publisher(CameraInfo, 'depth/camera_info', qos)
        self.mask = probe.create_publisher(Image, 'mask', qos) if mask else None
        self.all = list(filter(None, (self.depth, self.info, self.mask)))
        self._handshake = Handshake(probe)

    def wait_for_connections(self) -> None:
        assert wait_until(lambda: all(each.get_subscription_count() for each in self.all))
        self._handshake.call()
        self.info.publish(CameraInfo())

    def wait_until_taken(self) -> None:
        """Wait until the program has taken one message of each topic from its queue."""
        self._handshake.call()


@pytest.mark.parametrize(('qos', 'reliable'), [(RELIABLE, True), (qos_profile_sensor_data, False)])
def test_subscription_is_as_the_publishers_are(
    *, listen: Callable[..., Program], probe: Node, qos: QoSProfile, reliable: bool
) -> None:
    program = listen()
    senders = Senders(probe, qos)
    senders.wait_for_connections()
    for topic in ('/depth/image', '/depth/camera_info', '/mask'):
        assert is_reliable(probe, topic, wanted=reliable), topic
    for number in range(5):
        senders.depth.publish(image(START + number * FRAME))
        senders.mask.publish(image(START + number * FRAME, 'mono8'))
        senders.wait_until_taken()
    expected = [(START + number * FRAME,) * 2 for number in range(5)]
    assert wait_until(lambda: pairs_of(program) == expected), program.output
    assert 'incompatible' not in program.output
    assert 'ERROR' not in program.output


def test_subscription_follows_when_the_publishers_change(
    listen: Callable[..., Program], probe: Node
) -> None:
    program = listen('segmentation=nearest')
    reliable = Senders(probe, mask=False)
    reliable.wait_for_connections()
    assert is_reliable(probe, '/depth/image', wanted=True)
    other = probe.create_publisher(Image, 'depth/image', qos_profile_sensor_data)
    assert is_reliable(probe, '/depth/image', wanted=False)
    assert wait_until(other.get_subscription_count)
    Handshake(probe).call()
    other.publish(image(START))
    assert program.prints(f'pair {START} None'), program.output
    reliable.depth.publish(image(START + FRAME))
    assert program.prints(f'pair {START + FRAME} None'), program.output
    probe.destroy_publisher(other)
    assert is_reliable(probe, '/depth/image', wanted=True)
    assert wait_until(reliable.depth.get_subscription_count)
    Handshake(probe).call()
    reliable.depth.publish(image(START + 2 * FRAME))
    assert program.prints(f'pair {START + 2 * FRAME} None'), program.output
    assert 'incompatible' not in program.output


def test_camera_info_that_was_published_once_before_is_received(
    listen: Callable[..., Program], probe: Node
) -> None:
    info = probe.create_publisher(CameraInfo, 'depth/camera_info', LATCHED)
    info.publish(CameraInfo())
    program = listen('segmentation=nearest')
    depth = probe.create_publisher(Image, 'depth/image', 10)
    assert wait_until(depth.get_subscription_count)
    Handshake(probe).call()
    depth.publish(image(START))
    assert program.prints(f'pair {START} None'), program.output


@pytest.mark.parametrize('reliability', ['reliable', 'best_effort'])
def test_reliability_can_be_set(
    listen: Callable[..., Program], probe: Node, reliability: str
) -> None:
    listen(f'reliability={reliability}')
    for topic in ('/depth/image', '/depth/camera_info', '/mask'):
        assert is_reliable(probe, topic, wanted=reliability == 'reliable'), topic


def test_incompatible_publisher_is_named_with_the_remedy(
    listen: Callable[..., Program], probe: Node
) -> None:
    program = listen('reliability=reliable')
    probe.create_publisher(Image, 'mask', qos_profile_sensor_data)
    assert program.prints('/mask: a publisher offers an incompatible RELIABILITY')
    assert 'set the parameter reliability to auto' in program.output


@pytest.mark.parametrize(
    ('topic', 'parameter'), [('depth/image', 'depth_transport'), ('mask', 'mask_transport')]
)
def test_publisher_of_another_type_is_named_with_the_remedy(
    listen: Callable[..., Program], probe: Node, topic: str, parameter: str
) -> None:
    program = listen()
    probe.create_publisher(CompressedImage, topic, 10)
    assert program.prints(f'/{topic}: a publisher sends sensor_msgs/msg/CompressedImage')
    assert f'set the parameter {parameter}' in program.output
    assert stays(lambda: program.output.count('a publisher sends') == 1)


@pytest.mark.parametrize(
    ('qos', 'words', 'remedy'),
    [
        (RELIABLE, (), 'their publishers deliver reliably'),
        (RELIABLE, ('reliability=best_effort',), 'set the parameter reliability to auto'),
        (qos_profile_sensor_data, (), 'let them publish reliably'),
    ],
)
def test_remedy_against_missing_images_fits_what_is_offered(
    listen: Callable[..., Program],
    probe: Node,
    qos: QoSProfile,
    words: tuple[str, ...],
    remedy: str,
) -> None:
    program = listen('segmentation=nearest', *words)
    senders = Senders(probe, qos, mask=False)
    senders.wait_for_connections()
    for number in range(40):
        stamp = START + FRAME * (number if number < 20 else number + 20)
        senders.depth.publish(image(stamp))
        senders.wait_until_taken()
    assert program.prints('depth images are missing; '), program.output
    assert remedy in program.output


def test_player_of_recordings_gets_the_hint_to_wait(
    listen: Callable[..., Program], start_program: Callable[..., Program]
) -> None:
    program = listen('segmentation=nearest')
    hint = '/depth/image: ros2 bag play sent its first messages before this node was connected'

    def hint_is_given() -> bool:
        # On a busy computer, the first message may come as late as with a delay.
        before = counters_of(program).depth
        player = start_program('-c', PLAYER, 'at once')
        assert wait_until(lambda: counters_of(program).depth > before)
        player.kill()
        assert program.prints('counters')
        return hint in program.output

    assert program.prints('counters')
    assert wait_until(hint_is_given), program.output
    assert 'with --delay 3 it waits' in program.output


def test_player_of_recordings_that_waits_gets_no_hint(
    listen: Callable[..., Program], start_program: Callable[..., Program]
) -> None:
    program = listen('segmentation=nearest')
    assert program.prints('counters')
    start_program('-c', PLAYER, 'delay')
    assert wait_until(lambda: counters_of(program).depth)
    assert 'bag play' not in program.output


def test_silence_is_told_topic_by_topic(listen: Callable[..., Program], probe: Node) -> None:
    program = listen()
    probe.create_publisher(Image, 'depth/image', 10)
    assert program.prints('nothing received on /depth/image for 1 s (')
    assert program.prints('nothing received on /mask for 1 s (no publishers)')
    assert program.prints('no camera info received on /depth/camera_info (no publishers)')
    assert '[WARN]' in program.output


def test_compressed_images_come_beside_their_remapped_topics(
    listen: Callable[..., Program], probe: Node
) -> None:
    program = listen(
        *('depth_transport=compressedDepth', 'mask_transport=compressed', '--ros-args'),
        *('-r', 'depth/image:=/kinect/depth', '-r', '__ns:=/robot'),
    )
    names = '/kinect/depth/compressedDepth /robot/depth/camera_info /robot/mask/compressed'
    assert f'listening to {names}' in program.output
    depth, info, mask = (
        probe.create_publisher(kind, name, 10)
        for kind, name in zip(
            (CompressedImage, CameraInfo, CompressedImage), names.split(), strict=True
        )
    )
    for each in (depth, info, mask):
        assert wait_until(each.get_subscription_count)
    Handshake(probe, '/robot/pose_node').call()
    info.publish(CameraInfo())
    form, data = encode_compressed_depth(np.ones((3, 4), np.uint16))
    depth.publish(stamped(CompressedImage(format=form, data=array.array('B', data)), START))
    png = array.array('B', write_png(np.ones((3, 4), np.uint8)))
    mask.publish(stamped(CompressedImage(format='mono8; png compressed', data=png), START))
    assert program.prints(f'pair {START} {START}'), program.output


def test_late_double_and_disordered_images_are_counted_and_told(
    listen: Callable[..., Program], probe: Node
) -> None:
    program = listen()
    senders = Senders(probe)
    senders.wait_for_connections()
    stamps = [START + number * FRAME for number in range(12)]
    for stamp in stamps:
        senders.depth.publish(image(stamp))
        senders.wait_until_taken()
    for number in (1, 0, 3, 3, 2, 5, 4, 7, 6, 9, 8, 11):
        senders.mask.publish(image(stamps[number], 'mono8'))
        senders.wait_until_taken()
    senders.depth.publish(image(stamps[2]))
    odd = [(stamp, stamp) for stamp in stamps[1::2]]
    assert wait_until(lambda: pairs_of(program) == odd), program.output
    assert wait_until(lambda: 'late=6' in program.output), program.output
    counters = counters_of(program)
    assert counters._replace(lost=0, missing=0) == Counters(
        depth=13,
        masks=12,
        camera_infos=1,
        pairs=6,
        unmatched_depth=6,
        duplicates=1,
        late=6,
        out_of_order=6,
    )
    assert program.prints('came after newer ones; let one publisher send each topic')


def test_near_stamps_pair_within_the_slop(listen: Callable[..., Program], probe: Node) -> None:
    program = listen('sync_slop=0.005')
    senders = Senders(probe)
    senders.wait_for_connections()
    for number in range(3):
        senders.depth.publish(image(START + number * FRAME))
        senders.mask.publish(image(START + number * FRAME + 4_000_000, 'mono8'))
        senders.wait_until_taken()
    senders.mask.publish(image(START + 3 * FRAME + 6_000_000, 'mono8'))
    senders.depth.publish(image(START + 3 * FRAME))
    expected = [
        (START + number * FRAME, START + number * FRAME + 4_000_000) for number in range(3)
    ]
    assert wait_until(lambda: pairs_of(program) == expected), program.output
    senders.wait_until_taken()
    assert stays(lambda: pairs_of(program) == expected)


def test_missing_images_are_told_with_the_profile(
    listen: Callable[..., Program], probe: Node
) -> None:
    program = listen('segmentation=background')
    senders = Senders(probe, qos_profile_sensor_data, mask=False)
    senders.wait_for_connections()
    random = np.random.default_rng(0)
    for number in np.flatnonzero(random.random(400) < 0.5):
        senders.depth.publish(image(START + int(number) * FRAME))
        senders.wait_until_taken()
    assert program.prints('according to the stamps of /depth/image'), program.output
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in program.output
    assert wait_until(lambda: counters_of(program).missing > 100)


def test_closing_ends_at_once_and_quietly(listen: Callable[..., Program], probe: Node) -> None:
    program = listen()
    Senders(probe).wait_for_connections()
    begin = time.monotonic()
    assert program.exit_status(signal.SIGTERM) == 0, program.output
    assert time.monotonic() - begin < MOST_UNTIL_ENDED
    assert 'closed' in program.output
    assert 'Traceback' not in program.output
