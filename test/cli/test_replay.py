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

"""`lsc_pose replay -o`: every frame of a recording answered offline."""

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from lsc_pose_ros.bags import (
    DEFAULT_TOPICS,
    RecordingWriter,
    open_recording,
    read_messages,
)
from lsc_pose_ros.bags.estimated_copy import MARKERS_TOPIC, SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    mask_message,
)
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.messages.type_names import CAMERA_INFO, IMAGE, MARKER_ARRAY, POINT_CLOUD
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.settings.table import TRACKED, TemporalSettings

LATE = 250_000_000


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory, people: list[Frame]) -> Path:
    """Twelve labelled frames as a recorder would have them: log times later than stamps."""
    path = tmp_path_factory.mktemp('replay') / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:12]:
            write(writer, frame)
            writer.write('/chatter', 'std_msgs/msg/String', frame.stamp, bytes(12))
    return path


def write(writer: RecordingWriter, frame: Frame, *, masked: bool = True) -> None:
    head, time = (frame.stamp, frame.frame_id), frame.stamp + LATE
    writer.write('/depth/image', IMAGE, time, depth_message(*head, frame.depth))
    info = camera_info_message(*head, frame.camera, frame.depth.shape)
    writer.write('/depth/camera_info', CAMERA_INFO, time + 1, info)
    if masked:
        writer.write('/mask', IMAGE, time + 2, mask_message(*head, frame.labels))
    writer.write_skeletons('/ground_truth/skeletons', *head, frame.ground_truth)


@pytest.fixture
def replay(tmp_path: Path, small_model_file: Path) -> Callable[..., Path]:
    """Replay a recording and return the new one."""

    def run(path: Path, *words: str) -> Path:
        output = tmp_path / 'out.mcap'
        status = main(
            ['replay', str(path), '-o', str(output), '--model', str(small_model_file), *words]
        )
        assert status == 0
        return output

    return run


def of(path: Path, topic: str) -> list[bytes]:
    return [message.data for message in read_messages(path) if message.topic == topic]


def times(path: Path, topic: str) -> list[int]:
    return [message.log_time for message in read_messages(path) if message.topic == topic]


def test_original_messages_are_passed_through(
    replay: Callable[..., Path], recording: Path
) -> None:
    output = replay(recording)
    for topic in DEFAULT_TOPICS:
        assert of(output, topic) == of(recording, topic)
        assert times(output, topic) == times(recording, topic)
    assert set(read_messages(output).topics) == {*DEFAULT_TOPICS, SKELETONS_TOPIC, MARKERS_TOPIC}


def test_every_frame_is_answered_with_the_estimators_joints(
    replay: Callable[..., Path], recording: Path, small_model_file: Path
) -> None:
    estimator = Estimator(load_model(small_model_file))
    output = replay(recording, '--no-temporal')
    answers = [read_skeletons(data) for data in of(output, SKELETONS_TOPIC)]
    frames = list(open_recording(recording))
    assert [answer.stamp for answer in answers] == [frame.stamp for frame in frames]
    for answer, frame in zip(answers, frames, strict=True):
        expected = estimator.estimate(frame.depth, frame.labels, frame.camera)
        for found, wanted in zip(answer.skeletons, expected, strict=True):
            np.testing.assert_array_equal(found, wanted)
    assert np.isfinite(answers[0].skeletons.positions).any()


def test_answers_have_the_time_of_their_depth_image(
    replay: Callable[..., Path], recording: Path
) -> None:
    output = replay(recording)
    for topic in (SKELETONS_TOPIC, MARKERS_TOPIC):
        assert times(output, topic) == times(recording, '/depth/image')


def read_with_rosbags(path: Path, topic: str) -> list[Any]:
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        connections = [each for each in reader.connections if each.topic == topic]
        return [
            reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages(connections)
        ]


def test_others_read_skeletons_and_markers(
    replay: Callable[..., Path], recording: Path, people: list[Frame]
) -> None:
    output = replay(recording)
    topics = read_messages(output).topics
    assert topics[SKELETONS_TOPIC].type_name == POINT_CLOUD
    assert topics[MARKERS_TOPIC].type_name == MARKER_ARRAY
    clouds = read_with_rosbags(output, SKELETONS_TOPIC)
    markers = read_with_rosbags(output, MARKERS_TOPIC)
    assert len(clouds) == len(markers) == 12
    assert {cloud.header.frame_id for cloud in clouds} == {people[0].frame_id}
    assert [len(message.markers) for message in markers] == [2] * 12
    assert all(len(message.markers[0].points) for message in markers)


def test_markers_of_a_body_that_left_are_deleted(
    replay: Callable[..., Path], people: list[Frame], tmp_path: Path
) -> None:
    path = tmp_path / 'leaving.mcap'
    empty = people[1]._replace(labels=np.full_like(people[1].labels, NO_BODY))
    with RecordingWriter(path) as writer:
        for frame in (people[0], empty, people[2]):
            write(writer, frame)
    actions = [
        {(marker.id, marker.action) for marker in message.markers}
        for message in read_with_rosbags(replay(path), MARKERS_TOPIC)
    ]
    assert actions == [{(1, 0)}, {(1, 2)}, {(1, 0)}]


def test_frames_without_a_mask_are_copied_but_not_answered(
    replay: Callable[..., Path],
    people: list[Frame],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / 'gaps.mcap'
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(people[:9]):
            write(writer, frame, masked=number % 3 == 1)
    output = replay(path)
    assert len(of(output, '/depth/image')) == 9
    stamps = [read_skeletons(data).stamp for data in of(output, SKELETONS_TOPIC)]
    assert stamps == [frame.stamp for frame in people[1:9:3]]
    assert '6 of /depth/image were left out' in capsys.readouterr().err


def test_compressed_and_renamed_topics_are_passed_through_under_their_names(
    replay: Callable[..., Path], people: list[Frame], tmp_path: Path
) -> None:
    path = tmp_path / 'renamed.mcap'
    topics = DEFAULT_TOPICS._replace(depth='/kinect/z', mask='/kinect/who', ground_truth='')
    with RecordingWriter(path) as writer:
        for frame in people[:3]:
            writer.write_frame(frame, topics)
    output = replay(path, '--depth-topic', '/kinect/z', '--mask-topic', '/kinect/who')
    assert len(of(output, '/kinect/z')) == len(of(output, SKELETONS_TOPIC)) == 3


def test_truncated_recording_is_answered_up_to_the_damage(
    replay: Callable[..., Path],
    recording: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / 'cut.mcap'
    with RecordingWriter(path) as writer:
        for number in range(40):
            for frame in list(open_recording(recording))[:12]:
                write(writer, frame._replace(stamp=frame.stamp + number * 10**9))
    data = path.read_bytes()
    path.write_bytes(data[: 2 * len(data) // 3])
    output = replay(path)
    assert 0 < len(of(output, SKELETONS_TOPIC)) < 480
    assert 'read up to there' in capsys.readouterr().err


def test_without_graph(
    replay: Callable[..., Path], recording: Path, small_model_file: Path
) -> None:
    frame = next(iter(open_recording(recording)))
    alone = Estimator(load_model(small_model_file), graph=False)
    expected = alone.estimate(frame.depth, frame.labels, frame.camera)
    answer = read_skeletons(of(replay(recording, '--no-graph'), SKELETONS_TOPIC)[0])
    np.testing.assert_array_equal(answer.skeletons.positions, expected.positions)


def test_parameters_of_the_node_are_options(
    replay: Callable[..., Path], recording: Path, small_model_file: Path
) -> None:
    model = load_model(small_model_file)
    settings = model.settings._replace(query_points=60)
    sequence = TemporalEstimator(
        Estimator(model._replace(settings=settings)),
        TemporalSettings(TRACKED, smoothing=True, smoothing_cutoff=0.7, smoothing_beta=3.0),
    )
    words = '--query-points 60 --body-ids tracked --smoothing --smoothing-cutoff 0.7'
    output = replay(recording, *words.split(), '--smoothing-beta', '3')
    answers = [read_skeletons(data) for data in of(output, SKELETONS_TOPIC)]
    frames = list(open_recording(recording))
    for answer, frame in zip(answers, frames, strict=True):
        expected = sequence.estimate(frame.stamp, frame.depth, frame.labels, frame.camera)
        for found, wanted in zip(answer.skeletons, expected, strict=True):
            np.testing.assert_array_equal(found, wanted)


def test_markers_as_asked_for(replay: Callable[..., Path], recording: Path) -> None:
    output = replay(recording, '--minimum-confidence', '0.99', '--marker-lifetime', '2.5')
    markers = read_with_rosbags(output, MARKERS_TOPIC)[0].markers
    full = read_with_rosbags(replay(recording), MARKERS_TOPIC)[0].markers
    assert len(markers[0].points) < len(full[0].points)
    assert (full[0].lifetime.sec, full[0].lifetime.nanosec) == (0, 500_000_000)
    assert {(each.lifetime.sec, each.lifetime.nanosec) for each in markers} == {(2, 500_000_000)}


def stands(frame: Frame) -> bool:
    """Whoever is low on the floor has not the size of a body."""
    assert frame.ground_truth is not None
    heights = -frame.ground_truth.positions[0, :, 1]
    return bool(heights[JOINT_NUMBERS['head']] - heights[JOINT_NUMBERS['l_foot']] > 0.8)


@pytest.mark.parametrize('masks', ['none', 'of every third frame'])
def test_bodies_found_without_masks(
    masks: str, replay: Callable[..., Path], people: list[Frame], tmp_path: Path
) -> None:
    path = tmp_path / 'unmasked.mcap'
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(itertools.islice(filter(stands, people), 6)):
            write(writer, frame, masked=masks != 'none' and number % 3 == 0)
    output = replay(path, '--segmentation', 'nearest', '--body-ids', 'mask')
    answers = [read_skeletons(data).skeletons for data in of(output, SKELETONS_TOPIC)]
    assert len(answers) == 6
    assert all(answer.bodies.tolist() == [1] for answer in answers)
    assert np.isfinite(answers[0].positions).any()


def test_nobody_within_the_range(
    recording: Path, small_model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (recording, '-o', tmp_path / 'out.mcap', '--model', small_model_file)
    ranges = ('--range-min', '0.1', '--range-max', '0.2')
    text = complain(capsys, *words, '--segmentation', 'nearest', *ranges)
    assert 'nobody is found in 12 frames' in text
    assert 'found by segmentation nearest' in text
    assert list(tmp_path.iterdir()) == []


def test_a_room_without_anybody_is_no_error_if_people_are_searched(
    recording: Path, small_model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'out.mcap'
    words = ('replay', recording, '-o', output, '--model', small_model_file)
    ranges = ('--range-min', '0.1', '--range-max', '0.2')
    assert main([str(word) for word in (*words, '--segmentation', 'people', *ranges)]) == 0
    assert 'warning' in (text := capsys.readouterr().err)
    assert 'nobody is found in 12 frames' in text
    assert output.exists()


@pytest.mark.parametrize(
    ('words', 'reason'),
    [
        (['--query-points', '5'], '--query-points: 5 cannot be used'),
        (['--query-points', '9999'], '--query-points: 9999 cannot be used'),
        (['--segmentation', 'nearest', '--range-min', '6'], 'range'),
    ],
)
def test_values_that_cannot_be_used(
    words: list[str],
    reason: str,
    recording: Path,
    small_model_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    output = tmp_path / 'out.mcap'
    text = complain(capsys, recording, '-o', output, '--model', small_model_file, *words)
    assert reason in text
    assert not output.exists()


def complain(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    assert main(['replay', *map(str, words)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    return lines[0]


def test_recording_cannot_be_written_over_itself(
    recording: Path, small_model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = recording.read_bytes()
    text = complain(capsys, recording, '-o', recording, '--model', small_model_file)
    assert 'is the input' in text
    assert recording.read_bytes() == before


def test_missing_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = complain(capsys, tmp_path / 'no.mcap', '-o', tmp_path / 'out.mcap')
    assert 'no.mcap' in text


def test_models_of_the_package(
    recording: Path,
    replay: Callable[..., Path],
    small_model_file: Path,
    shipped: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    wanted = of(replay(recording), SKELETONS_TOPIC)
    output = tmp_path / 'other.mcap'
    assert 'no model comes with this' in complain(capsys, recording, '-o', output)
    for name, words in (('front', ('--model', 'front')), ('default', ())):
        line = complain(capsys, recording, '-o', output, '--model', name)
        assert f'no model {name} comes with' in line
        (shipped / f'{name}.npz').write_bytes(small_model_file.read_bytes())
        assert main(['replay', str(recording), '-o', str(output), *words]) == 0
        assert of(output, SKELETONS_TOPIC) == wanted
        output.unlink()
    assert 'its models are default, front' in complain(
        capsys, recording, '-o', output, '--model', 'back'
    )


def test_missing_model_leaves_no_output(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (recording, '-o', tmp_path / 'out.mcap', '--model', tmp_path / 'no.npz')
    assert 'no.npz' in complain(capsys, *words)
    assert list(tmp_path.iterdir()) == []


def test_bad_messages_leave_no_output(
    recording: Path,
    people: list[Frame],
    small_model_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / 'bad.mcap'
    with RecordingWriter(path) as writer:
        for each in people[:2]:
            write(writer, each._replace(camera=each.camera._replace(fx=0.0)))
    output = tmp_path / 'out.mcap'
    text = complain(capsys, path, '-o', output, '--model', small_model_file)
    assert '/depth/camera_info' in text
    assert [each.name for each in tmp_path.iterdir()] == ['bad.mcap']
    assert recording.exists()


def test_recording_without_masks(
    people: list[Frame], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'unmasked.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:3]:
            writer.write_frame(frame, DEFAULT_TOPICS._replace(mask=''))
    words = (path, '-o', tmp_path / 'out.mcap', '--segmentation', 'mask')
    assert 'no mask topic' in complain(capsys, *words)


@pytest.mark.parametrize(
    'words',
    [
        [],
        ['-o', 'out.mcap', '--publish'],
        ['--publish', '--rate', '0'],
        ['--publish', '--rate', 'fast'],
        ['--publish', '--remap', '/depth'],
        ['--publish', '--wait-for', '-1'],
        ['-o', 'out.mcap', '--smoothing-cutoff', '0'],
        ['-o', 'out.mcap', '--smoothing-beta', '-1'],
        ['-o', 'out.mcap', '--segmentation', 'magic'],
        ['-o', 'out.mcap', '--body-ids', 'none'],
        ['-o', 'out.mcap', '--range-max', 'inf'],
    ],
)
def test_words_that_make_no_sense(
    words: list[str], recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as error:
        main(['replay', str(recording), *words])
    assert error.value.code == 2
    assert 'usage: lsc_pose replay' in capsys.readouterr().err


def test_empty_masks_leave_no_output(
    small_model_file: Path, people: list[Frame], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, output = tmp_path / 'empty.mcap', tmp_path / 'out.mcap'
    with RecordingWriter(recording) as writer:
        for frame in people[:3]:
            write(writer, frame._replace(labels=np.full_like(frame.labels, NO_BODY)))
    words = ['replay', str(recording), '-o', str(output), '--model', str(small_model_file)]
    assert main(words) == 2
    assert 'the masks of all 3 frames are empty' in capsys.readouterr().err
    assert not output.exists()


@pytest.mark.parametrize(
    ('words', 'option'),
    [
        (('--publish', '--model', 'front'), '--model has no effect without -o'),
        (('--publish', '--smoothing'), '--smoothing has no effect without -o'),
        (('-o', 'OUT', '--rate', '2'), '--rate has no effect without --publish'),
        (('-o', 'OUT', '--remap', '/a:=/b'), '--remap has no effect without --publish'),
    ],
)
def test_options_without_effect_are_refused(
    recording: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    option: str,
) -> None:
    given = [str(tmp_path / 'out.mcap') if word == 'OUT' else word for word in words]
    assert option in complain(capsys, recording, *given)
