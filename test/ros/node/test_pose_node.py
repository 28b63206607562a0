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

"""The live node: real messages in, real messages out, in a process of its own."""

import re
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import (
    MOST_UNTIL_ENDED,
    Camera,
    Handshake,
    NodeServices,
    NodeUnderTest,
    Program,
    PublishedEstimates,
    generate,
)
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CompressedImage, Image, PointField
from visualization_msgs.msg import Marker
from waiting import wait_until

from lsc_pose_ros.bags.serialization.serialize import camera_info_message, mask_message
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import SegmentationSettings

SLOW_NODE = Path(__file__).parent / 'slow_node.py'

# Images a second of a fast camera.
CAMERA_RATE = 100.0

# Seconds in which the node logs the same trouble once.
THROTTLE_PERIOD = 5.0

DEFAULT_CAMERA = Path(__file__).parent / 'default_camera.py'


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """One person."""
    return generate(tmp_path_factory.mktemp('one'))


@pytest.fixture(scope='module')
def pairs(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """Two people."""
    return generate(tmp_path_factory.mktemp('two'), people=2, frames=10)


@pytest.fixture(scope='module')
def model(small_model_file: Path) -> Model:
    """The model as the node reads it; a file holds half the digits."""
    return load_model(small_model_file)


def assert_equal(found: Skeletons, expected: Skeletons) -> None:
    for name in Skeletons._fields:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)


def offline(model: Model, frames: list[Frame]) -> dict[int, Skeletons]:
    estimator = Estimator(model)
    return {
        frame.stamp: estimator.estimate(frame.depth, frame.labels, frame.camera)
        for frame in frames
    }


def later(frames: list[Frame], seconds: int) -> list[Frame]:
    return [frame._replace(stamp=frame.stamp + seconds * 10**9) for frame in frames]


def wait_for_connections(camera: Camera, estimates: PublishedEstimates) -> None:
    camera.wait_for_node()
    estimates.wait_for_node()


def test_every_frame_is_answered_as_offline(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    model: Model,
) -> None:
    node = start_node()
    wait_for_connections(camera, estimates)
    for count, frame in enumerate(frames, 1):  # a busy node would skip to the newest frame
        camera.send(frame)
        assert estimates.wait_for(count), node.output
    expected = offline(model, frames)
    found = estimates.skeletons
    assert list(found) == [frame.stamp for frame in frames]
    for stamp, skeletons in found.items():
        assert_equal(skeletons, expected[stamp])
    assert np.isfinite([each.positions for each in found.values()]).any()
    assert {cloud.header.frame_id for cloud in estimates.clouds} == {frames[0].frame_id}
    assert node.exit_status(signal.SIGINT) == 0
    # A busy computer may take so long to connect them that the node says what is silent.
    warnings = [line for line in node.output.splitlines() if 'WARN' in line]
    assert all(' received on ' in each for each in warnings), warnings
    assert 'ERROR' not in node.output


def test_messages_are_as_promised(
    active_node: NodeUnderTest, pairs: list[Frame], model: Model
) -> None:
    _, camera, estimates, services = active_node
    assert not services.set('marker_lifetime', 1.5)
    both, nobody = pairs[0], pairs[2]._replace(labels=np.full_like(pairs[0].labels, NO_BODY))
    only_second = pairs[1]._replace(labels=np.where(pairs[1].labels == 2, 2, NO_BODY))
    for count, frame in enumerate((both, only_second, nobody), 1):
        camera.send(frame)
        assert estimates.wait_for(count)
    first, second, third = estimates.clouds
    joints = len(model.joints)
    assert [(f.name, f.offset, f.datatype, f.count) for f in first.fields] == [
        ('x', 0, PointField.FLOAT32, 1),
        ('y', 4, PointField.FLOAT32, 1),
        ('z', 8, PointField.FLOAT32, 1),
        ('confidence', 12, PointField.FLOAT32, 1),
        ('body', 16, PointField.UINT16, 1),
        ('joint', 18, PointField.UINT16, 1),
    ]
    assert (first.height, first.width, first.point_step) == (2, joints, 20)
    assert first.row_step == 20 * joints
    assert len(first.data) == 2 * first.row_step
    assert (second.height, second.width) == (1, joints)
    assert (third.height, third.width, len(third.data)) == (0, joints, 0)
    assert third.header.stamp.sec * 10**9 + third.header.stamp.nanosec == nobody.stamp

    drawn, less, none = (message.markers for message in estimates.markers)
    kinds = {(each.id, each.type, each.action) for each in drawn}
    assert kinds == {
        (body, kind, Marker.ADD)
        for body in (1, 2)
        for kind in (Marker.SPHERE_LIST, Marker.LINE_LIST)
    }
    for marker in drawn:
        assert marker.header == first.header
        assert len(marker.points) == len(marker.colors) > 0
        assert (marker.lifetime.sec, marker.lifetime.nanosec) == (1, 500_000_000)
    deleted = {(each.id, each.ns) for each in less if each.action == Marker.DELETE}
    assert deleted == {(each.id, each.ns) for each in drawn if each.id == 1}
    assert {each.id for each in less if each.action == Marker.ADD} == {2}
    assert {(each.id, each.action) for each in none} == {(2, Marker.DELETE)}


def test_person_who_is_hardly_seen_is_nan_without_markers(
    active_node: NodeUnderTest, frames: list[Frame]
) -> None:
    _, camera, estimates, _ = active_node
    labels = np.full_like(frames[0].labels, NO_BODY)
    labels[50:53, 70:73] = 4
    camera.send(frames[0]._replace(labels=labels))
    assert estimates.wait_for(1)
    (skeletons,) = estimates.skeletons.values()
    assert skeletons.bodies.tolist() == [4]
    assert np.isnan(skeletons.positions).all()
    assert (skeletons.confidence == 0).all()
    assert not estimates.clouds[0].is_dense
    assert {each.action for each in estimates.markers[0].markers} == {Marker.DELETE}


def test_mask_slower_and_later_than_depth(
    active_node: NodeUnderTest, frames: list[Frame], model: Model
) -> None:
    _, camera, estimates, _ = active_node
    delay = 6
    masked = frames[: len(frames) - delay : 3]
    for number, frame in enumerate(frames):
        camera.send_depth(frame)
        camera.wait_until_taken()
        if number >= delay and number % 3 == 0:
            camera.send_mask(frames[number - delay])
            assert estimates.wait_for((number - delay) // 3 + 1)
    expected = offline(model, masked)
    assert list(estimates.skeletons) == list(expected)
    for stamp, skeletons in estimates.skeletons.items():
        assert_equal(skeletons, expected[stamp])


def test_bad_messages_are_named_and_the_next_frame_is_answered(
    active_node: NodeUnderTest, frames: list[Frame]
) -> None:
    node, camera, estimates, _ = active_node
    good = frames[0]

    camera.depth.publish(stamped(Image(encoding='rgb8', height=1, width=1), frames[1].stamp))
    camera.camera_info.publish(camera_info_message(1, 'c', good.camera, good.depth.shape))
    camera.send_mask(frames[1])
    assert node.prints("/depth/image: depth image: unknown encoding 'rgb8'"), node.output

    camera.send_depth(frames[2])
    camera.send_mask(frames[2]._replace(labels=frames[2].labels[:60]))
    assert node.prints('/mask: it is for 160 x 60 pixels'), node.output

    camera.send(frames[3]._replace(camera=good.camera._replace(fx=0.0, fy=0.0)))
    assert node.prints('/depth/camera_info: the matrix K'), node.output

    camera.send(good._replace(stamp=frames[4].stamp))
    assert estimates.wait_for(1), node.output
    assert list(estimates.skeletons) == [frames[4].stamp]
    assert 'Traceback' not in node.output


def stamped(image: Image, stamp: int) -> Image:
    image.header.stamp.sec, image.header.stamp.nanosec = divmod(stamp, 10**9)
    return image


def test_same_trouble_is_not_logged_with_every_frame(
    active_node: NodeUnderTest, frames: list[Frame]
) -> None:
    node, camera, _, _ = active_node
    begin = time.monotonic()
    for frame in frames:
        camera.send(frame._replace(camera=frame.camera._replace(fx=0.0)))
        camera.wait_until_taken()
    assert node.prints('the matrix K')
    periods = (time.monotonic() - begin) // THROTTLE_PERIOD
    assert node.output.count('the matrix K') <= min(1 + periods, len(frames) - 1)


def test_recording_that_is_played_twice_is_answered_twice(
    active_node: NodeUnderTest, frames: list[Frame]
) -> None:
    node, camera, estimates, _ = active_node
    for count, frame in enumerate([*frames, *frames], 1):
        camera.send(frame)
        assert estimates.wait_for(count), (count, node.output)
    assert node.prints('went back')


@pytest.fixture
def slow_node(
    start_program: Callable[..., Program], small_model_file: Path
) -> Callable[[float], Program]:
    def begin(seconds: float) -> Program:
        model = f'model:={small_model_file}'
        node = start_program(
            SLOW_NODE,
            seconds,
            '--ros-args',
            '-p',
            model,
            '-p',
            'sync_queue:=1000',
            *('-p', 'temporal:=false'),
        )
        assert node.prints('ready')
        return node

    return begin


def resident_bytes(pid: int) -> int:
    status = Path(f'/proc/{pid}/status').read_text()
    return int(re.search(r'VmRSS:\s*(\d+) kB', status)[1]) * 1024


def test_overload_newest_wins_and_memory_does_not_grow(
    slow_node: Callable[[float], Program],
    camera: Camera,
    estimates: PublishedEstimates,
    tmp_path: Path,
) -> None:
    frames = generate(tmp_path, frames=60, width=320, height=240, rate=100.0)
    flood = [*frames, *later(frames, 1), *later(frames, 2), *later(frames, 3)]
    node = slow_node(0.25)
    wait_for_connections(camera, estimates)
    begin = time.monotonic()
    for frame in frames[:30]:  # so that all buffers have been in use
        camera.send(frame._replace(stamp=frame.stamp - 10**9))
        time.sleep(1 / CAMERA_RATE)
    assert estimates.wait_for(1), node.output
    before = resident_bytes(node.pid)
    for frame in flood:
        camera.send(frame)
        time.sleep(1 / CAMERA_RATE)
    last = flood[-1].stamp
    assert wait_until(lambda: last in estimates.skeletons), node.output
    seconds = time.monotonic() - begin
    answered = list(estimates.skeletons)
    assert answered == sorted(answered)
    assert len(answered) <= seconds / 0.25  # the slow node takes at least that long for each
    # 240 frames of depth and mask are 55 MB.
    assert resident_bytes(node.pid) - before < 20e6
    assert node.prints('frames were left out because newer ones replaced them'), node.output


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_signal_ends_the_node_at_once_and_quietly(
    slow_node: Callable[[float], Program],
    camera: Camera,
    frames: list[Frame],
    number: signal.Signals,
) -> None:
    node = slow_node(0.2)
    camera.wait_for_node()
    for frame in frames[:10]:  # it is at work when the signal comes
        camera.send(frame)
        camera.wait_until_taken()
    begin = time.monotonic()
    assert node.exit_status(number) == 0
    assert time.monotonic() - begin < MOST_UNTIL_ENDED
    assert 'Traceback' not in node.output
    assert 'rror' not in node.output


def test_publisher_of_best_effort_does_not_suit_reliable(
    start_node: Callable[..., Program], probe: Node
) -> None:
    node = start_node(reliability='reliable')
    probe.create_publisher(Image, 'depth/image', qos_profile_sensor_data)
    assert node.prints('/depth/image: a publisher offers an incompatible RELIABILITY')
    assert 'set the parameter reliability to auto or best_effort' in node.output


def test_lost_images_are_told_with_the_remedy(
    start_node: Callable[..., Program], start_program: Callable[..., Program]
) -> None:
    node = start_node(reliability='best_effort')
    start_program(DEFAULT_CAMERA, 30, FASTRTPS_DEFAULT_PROFILES_FILE='')
    assert node.prints('the middleware lost'), node.output
    assert re.search(
        r'FASTRTPS_DEFAULT_PROFILES_FILE=\S+/config/fastdds_profile\.xml', node.output
    )


def test_with_the_profile_no_image_is_lost(
    start_node: Callable[..., Program], start_program: Callable[..., Program]
) -> None:
    node = start_node(reliability='best_effort', segmentation='mask')
    start_program(DEFAULT_CAMERA, 5)  # the profile's memory holds ten seconds of that
    # The same report that would name losses names what is silent.
    assert node.prints('nothing received on /mask for 5 s (no publishers)'), node.output
    assert 'lost' not in node.output


def test_compressed_depth(
    start_node: Callable[..., Program],
    probe: Node,
    estimates: PublishedEstimates,
    frames: list[Frame],
    model: Model,
) -> None:
    start_node(depth_transport='compressedDepth')
    camera = Camera(probe)
    topic = 'depth/image/compressedDepth'
    depth = probe.create_publisher(CompressedImage, topic, 10)
    publishers = (depth, camera.camera_info, camera.mask)
    assert wait_until(lambda: all(each.get_subscription_count() for each in publishers))
    Handshake(probe).call()
    estimates.wait_for_node()
    frame = frames[0]
    form, data = encode_compressed_depth(np.rint(frame.depth * 1000).astype('<u2'))
    message = CompressedImage(format=form, data=list(data))
    message.header.frame_id = frame.frame_id
    depth.publish(stamped(message, frame.stamp))
    head = (frame.stamp, frame.frame_id)
    camera.camera_info.publish(camera_info_message(*head, frame.camera, frame.depth.shape))
    camera.mask.publish(mask_message(*head, frame.labels))
    assert estimates.wait_for(1)
    assert_equal(estimates.skeletons[frame.stamp], offline(model, [frame])[frame.stamp])


def test_topics_are_relative_and_can_be_remapped(
    start_program: Callable[..., Program], small_model_file: Path, probe: Node
) -> None:
    node = start_program(
        *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', '-p', f'model:={small_model_file}'),
        *('-r', '__ns:=/robot', '-r', 'depth/image:=/kinect/depth_rect'),
    )
    assert node.prints('listening to /kinect/depth_rect, /robot/depth/camera_info, /robot/mask')
    names = {'/robot/pose_node/skeletons', '/robot/pose_node/joint_markers'}
    assert wait_until(lambda: names <= {name for name, _ in probe.get_topic_names_and_types()})


def test_nearest_body_needs_no_mask(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    model: Model,
) -> None:
    node = start_node(segmentation='nearest', range_max=4.0)
    assert '/mask' not in node.output
    wait_for_connections_without_mask(camera, estimates)
    segmenter = make_segmenter(SegmentationSettings('nearest', range_max=4.0))
    for count, frame in enumerate(frames[:3], 1):
        camera.send_depth(frame)
        assert estimates.wait_for(count), node.output
    for frame in frames[:3]:
        labels = segment(segmenter, frame.stamp, frame.depth, frame.camera)
        expected = Estimator(model).estimate(frame.depth, labels, frame.camera)
        assert np.isfinite(expected.positions).any()
        assert_equal(estimates.skeletons[frame.stamp], expected)


def test_background_is_learnt_before_anybody_is_seen(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    services: NodeServices,
) -> None:
    node = start_node(segmentation='background', background_seconds=0.2)
    assert node.prints('learning the empty scene')
    wait_for_connections_without_mask(camera, estimates)
    wall = np.full_like(frames[0].depth, 4.0)
    empty = [frame._replace(depth=wall) for frame in frames[:10]]
    seen = [
        frame._replace(depth=np.where(frame.labels != NO_BODY, frame.depth, wall))
        for frame in frames[10:12]
    ]
    for count, frame in enumerate([*empty, *seen], 1):
        camera.send_depth(frame)
        assert estimates.wait_for(count), node.output
    assert node.prints('the empty scene is learnt')
    bodies = [each.bodies.tolist() for each in estimates.skeletons.values()]
    assert bodies == [[]] * 10 + [[1]] * 2

    assert services.change('deactivate')
    assert services.change('activate')
    assert wait_until(lambda: node.output.count('learning the empty scene') == 2)


def wait_for_connections_without_mask(camera: Camera, estimates: PublishedEstimates) -> None:
    camera.wait_for_node(mask=False)
    estimates.wait_for_node()
    assert not camera.mask.get_subscription_count()


def test_bodies_keep_their_numbers_where_they_are_tracked(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
) -> None:
    start_node(body_ids='tracked')
    wait_for_connections(camera, estimates)
    for count, frame in enumerate(frames[:4], 1):
        number = np.where(frame.labels != NO_BODY, 10 + count, NO_BODY)
        camera.send(frame._replace(labels=number.astype(np.int32)))
        assert estimates.wait_for(count)
    assert [each.bodies.tolist() for each in estimates.skeletons.values()] == [[11]] * 4


def test_without_graph_the_joints_are_those_of_the_estimator_without(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    model: Model,
) -> None:
    start_node(graph='false', minimum_confidence=1.0)
    wait_for_connections(camera, estimates)
    camera.send(frames[0])
    assert estimates.wait_for(1)
    alone = Estimator(model, graph=False)
    expected = alone.estimate(frames[0].depth, frames[0].labels, frames[0].camera)
    assert_equal(estimates.skeletons[frames[0].stamp], expected)
    assert {each.action for each in estimates.markers[0].markers} == {Marker.DELETE}
