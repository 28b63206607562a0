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

"""`lsc_pose replay --publish`: a recording onto the wire, for real."""

import importlib.util
import re
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import MOST_UNTIL_ENDED, Program
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock
from waiting import PATIENCE, wait_until

from lsc_pose_ros.bags import RecordingWriter, SerializedMessage, read_messages
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.ros.playback.listener import open_listener
from lsc_pose_ros.ros.playback.player import _qos

IMAGE = 'sensor_msgs/msg/Image'
CAMERA_INFO = 'sensor_msgs/msg/CameraInfo'
CLOUD = 'sensor_msgs/msg/PointCloud2'
CLOCK = 'rosgraph_msgs/msg/Clock'
TOPICS = {
    '/depth/image': IMAGE,
    '/depth/camera_info': CAMERA_INFO,
    '/mask': IMAGE,
    '/ground_truth/skeletons': CLOUD,
}

# The command with a clock that only the pacer's sleeping moves.
VIRTUAL_CLOCK = """
import sys

from lsc_pose_ros.cli.main import main
from lsc_pose_ros.ros.playback import pacing

class Time:
    now = 50.0

    @classmethod
    def sleep(cls, seconds):
        cls.now += seconds

pacing.Pacer.__init__.__defaults__ = (lambda: Time.now, Time.sleep)
status = main(sys.argv[1:])
print(f'slept {Time.now - 50} s')
sys.exit(status)
"""


@pytest.fixture
def play(
    start_program: Callable[..., Program], labelled_recording: Path
) -> Callable[..., Program]:
    def begin(*words: object, recording: Path = labelled_recording) -> Program:
        return start_program('-m', 'lsc_pose_ros', 'replay', recording, '--publish', *words)

    return begin


def of(messages: list[SerializedMessage], topic: str) -> list[bytes]:
    return [message.data for message in messages if message.topic == topic]


def same(received: list[bytes], recorded: list[bytes]) -> bool:
    """Whether the messages are the same; the wire pads them to a multiple of 4 bytes."""
    padded = [data[4:] + bytes(-len(data) % 4) for data in recorded]
    return [data[4:] for data in received] == padded


def test_every_message_arrives_as_it_was_recorded(
    play: Callable[..., Program], labelled_recording: Path
) -> None:
    recorded = list(read_messages(labelled_recording))
    with open_listener(TOPICS) as listener:
        player = play('--wait-for', PATIENCE)
        assert player.exit_status() == 0, player.output
        assert listener.wait_for_messages(len(recorded), PATIENCE)
    for topic in TOPICS:
        assert same(of(listener.received, topic), of(recorded, topic)), topic
    assert f'{len(recorded)} messages published' in player.output


@pytest.mark.parametrize('rate', [0.5, 3.0])
def test_pace_is_that_of_the_recording_times_the_rate(
    start_program: Callable[..., Program], labelled_recording: Path, rate: float
) -> None:
    recorded = [each.log_time for each in read_messages(labelled_recording)]
    words = ['replay', str(labelled_recording), '--publish', '--rate', str(rate)]
    player = start_program('-c', VIRTUAL_CLOCK, *words)
    assert player.exit_status() == 0, player.output
    assert player.prints('slept ')
    slept = float(re.search(r'^slept (\S+) s$', player.output, re.MULTILINE)[1])
    assert slept == pytest.approx((max(recorded) - min(recorded)) * 1e-9 / rate, abs=1e-6)


def times_of(messages: list[SerializedMessage]) -> list[int]:
    clocks = [deserialize_message(data, Clock).clock for data in of(list(messages), '/clock')]
    return [clock.sec * 10**9 + clock.nanosec for clock in clocks]


def test_clock_tells_the_recorded_time(
    play: Callable[..., Program], labelled_recording: Path
) -> None:
    recorded = [each.log_time for each in read_messages(labelled_recording)]
    with open_listener({'/clock': CLOCK, **TOPICS}) as listener:
        assert play('--wait-for', PATIENCE, '--clock', '--rate', 0.2).exit_status() == 0
        assert wait_until(lambda: times_of(listener.received)[-1:] == [max(recorded)])
        times = times_of(listener.received)
    assert times == sorted(times)
    assert min(recorded) <= times[0]
    assert set(times) - set(recorded)  # it goes on between the frames


def test_without_clock_there_is_none(play: Callable[..., Program]) -> None:
    with open_listener({'/clock': CLOCK, **TOPICS}) as listener:
        assert play('--wait-for', PATIENCE).exit_status() == 0
        assert of(listener.received, '/clock') == []


def test_topics_can_be_renamed(play: Callable[..., Program], labelled_recording: Path) -> None:
    topics = {'/kinect/depth': IMAGE, '/depth/camera_info': CAMERA_INFO, '/mask': IMAGE}
    with open_listener(topics) as listener:
        words = ('--wait-for', PATIENCE, '--remap', '/depth/image:=/kinect/depth')
        assert play(*words).exit_status() == 0
        assert listener.wait_for_messages(30, PATIENCE)
    recorded = list(read_messages(labelled_recording))
    assert same(of(listener.received, '/kinect/depth'), of(recorded, '/depth/image'))


def test_loop_goes_on_until_it_is_stopped(
    play: Callable[..., Program], labelled_recording: Path
) -> None:
    count = len(of(list(read_messages(labelled_recording)), '/mask'))
    with open_listener({'/mask': IMAGE, '/depth/image': IMAGE}) as listener:
        player = play('--loop', '--rate', 5)
        assert listener.wait_for_messages(2 * 3 * count, PATIENCE)
        assert player.exit_status(signal.SIGINT) == 130
        masks = of(listener.received, '/mask')
    assert masks[:count] == masks[count : 2 * count]


@pytest.mark.parametrize(('number', 'status'), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_signal_ends_the_player_at_once_and_quietly(
    play: Callable[..., Program],
    number: signal.Signals,
    status: int,
) -> None:
    with open_listener(TOPICS) as listener:
        player = play('--wait-for', PATIENCE, '--rate', 0.02)
        assert listener.wait_for_messages(1, PATIENCE)
        begin = time.monotonic()
        assert player.exit_status(number) == status
    assert time.monotonic() - begin < MOST_UNTIL_ENDED
    assert 'Traceback' not in player.output
    assert 'error' not in player.output


def test_nobody_who_listens(play: Callable[..., Program]) -> None:
    player = play('--wait-for', 0.5)
    assert player.exit_status() == 2
    assert 'no subscriber to /depth/image, /depth/camera_info, /mask' in player.output
    assert 'start pose_node first' in player.output


def test_topic_that_is_not_there_cannot_be_renamed(play: Callable[..., Program]) -> None:
    player = play('--remap', '/nothing:=/something')
    assert player.exit_status() == 2
    assert 'no topic /nothing' in player.output
    assert '/depth/image' in player.output


def test_types_that_are_not_installed_are_left_out_with_a_warning(
    play: Callable[..., Program],
    simple_frames: list[Frame],
    tmp_path: Path,
) -> None:
    path = tmp_path / 'odd.mcap'
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame)
            writer.write('/map', 'nav_msgs/msg/MapMetaData', frame.stamp, bytes(100))
    with open_listener(TOPICS) as listener:
        player = play('--wait-for', PATIENCE, recording=path)
        assert player.exit_status() == 0, player.output
        assert listener.wait_for_messages(4 * len(simple_frames), PATIENCE)
    # It is installed where a whole ROS is sourced.
    left_out = importlib.util.find_spec('nav_msgs') is None
    warning = '/map is not played: the package of nav_msgs/msg/MapMetaData is not installed'
    assert (warning in player.output) == left_out


@pytest.mark.parametrize(
    'offered',
    [
        '- history: 3\n  depth: 1\n  reliability: 1\n  durability: 1\n',
        '  durability: transient_local',
    ],
)
def test_what_was_latched_is_latched_again(offered: str) -> None:
    assert _qos(offered).durability.name == 'TRANSIENT_LOCAL'
    assert _qos(offered).depth >= 100


@pytest.mark.parametrize('offered', ['', '  durability: 2\n', '  durability: volatile', 'x'])
def test_what_was_not_latched_is_not(offered: str) -> None:
    assert _qos(offered).durability.name == 'VOLATILE'
    assert _qos(offered).reliability.name == 'RELIABLE'


def test_without_ros_the_player_says_how_to_get_it(
    start_program: Callable[..., Program], labelled_recording: Path
) -> None:
    code = (
        'import sys; sys.modules["rclpy"] = None\n'
        'from lsc_pose_ros.cli.main import main\n'
        f'sys.exit(main(["replay", {str(labelled_recording)!r}, "--publish"]))'
    )
    player = start_program('-c', code)
    assert player.exit_status() == 2
    assert "pip install '.[ros]' in a clone" in player.output
