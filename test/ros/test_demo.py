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

"""The demonstration, and how it judges the live node."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Program

from lsc_pose_ros import demo
from lsc_pose_ros.bags import RecordingWriter, SerializedMessage, open_recording
from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.serialize import skeletons_message
from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.type_names import POINT_CLOUD
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.resources.package_files import default_model


def answer(frame: Frame, offset: float = 0.0, unknown: int = 0) -> Skeletons:
    """The ground truth, shifted along x, with the first joints left out."""
    positions = frame.ground_truth.positions + np.array([offset, 0, 0], np.float32)
    positions[:, :unknown] = np.nan
    return frame.ground_truth._replace(positions=positions)


def compared(
    frames: list[Frame], answers: dict[int, Skeletons], tmp_path: Path
) -> demo.LiveResult:
    path = tmp_path / 'live.mcap'
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(frames):
            writer.write_frame(frame)
            if number in answers:
                writer.write_skeletons(
                    SKELETONS_TOPIC, frame.stamp, frame.frame_id, answers[number]
                )
    return demo.live_result(path)


def test_perfect_answers_pass(simple_frames: list[Frame], tmp_path: Path) -> None:
    answers = {number: answer(frame) for number, frame in enumerate(simple_frames)}
    result = compared(simple_frames, answers, tmp_path)
    assert result == (10, 10, 0.0)
    assert result.passed


def test_error_is_the_mean_distance(simple_frames: list[Frame], tmp_path: Path) -> None:
    answers = {number: answer(frame, 0.09, 1) for number, frame in enumerate(simple_frames)}
    result = compared(simple_frames, answers, tmp_path)
    assert result.estimated == 10
    assert result.mean_error == pytest.approx(0.09, abs=1e-6)
    assert not result.passed


def test_missing_answers_fail(simple_frames: list[Frame], tmp_path: Path) -> None:
    answers = {number: answer(frame) for number, frame in enumerate(simple_frames) if number}
    result = compared(simple_frames, answers, tmp_path)
    assert result == (10, 9, 0.0)
    assert not result.passed


def test_answer_without_joints_of_somebody_is_none(
    simple_frames: list[Frame], tmp_path: Path
) -> None:
    answers = {number: answer(frame) for number, frame in enumerate(simple_frames)}
    answers[3].positions[1] = np.nan  # the second person
    answers[4] = answer(simple_frames[4], 0.0, 3)
    assert compared(simple_frames, answers, tmp_path).estimated == 8


def test_no_answer_at_all_fails(simple_frames: list[Frame], tmp_path: Path) -> None:
    result = compared(simple_frames, {}, tmp_path)
    assert result == (10, 0, float('inf'))
    assert not result.passed


def test_people_in_a_room_are_found_whatever_their_numbers_are(
    simple_frames: list[Frame], tmp_path: Path
) -> None:
    """One frame has no answer, one misses the first person, one has nobody near the people."""
    answers = {number: answer(frame, 0.1) for number, frame in enumerate(simple_frames) if number}
    answers[1] = answers[1]._replace(bodies=answers[1].bodies[::-1] + 5)
    answers[2].positions[0] = np.nan
    answers[3] = answer(simple_frames[3], 9.0)
    path = tmp_path / 'room.mcap'
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(simple_frames):
            writer.write_frame(frame)
            if number in answers:
                writer.write_skeletons(
                    SKELETONS_TOPIC, frame.stamp, frame.frame_id, answers[number]
                )
    each = len(simple_frames[0].ground_truth.bodies)
    result = demo.room_result(path)
    assert result.people == 10 * each
    assert result.found == 7 * each + each - 1
    assert result.mean_error == pytest.approx(0.1, abs=1e-6)


def test_answers_are_put_where_their_frames_are(
    simple_frames: list[Frame], labelled_recording: Path, tmp_path: Path
) -> None:
    answers = [
        SerializedMessage(
            SKELETONS_TOPIC,
            POINT_CLOUD,
            9 * 10**18,  # the time of the demonstration
            skeletons_message(frame.stamp, frame.frame_id, answer(frame)),
        )
        for frame in reversed(simple_frames)
    ]
    live = tmp_path / 'live.mcap'
    demo.write_live(labelled_recording, live, answers)
    assert demo.live_result(live) == (10, 10, 0.0)
    assert len(list(open_recording(live))) == 10


def test_directory_that_cannot_be_made(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / 'file').touch()
    assert demo.main(['--directory', str(tmp_path / 'file' / 'demo')]) == 2
    assert 'choose another --directory' in capfd.readouterr().err


def error_of_the_mean_pose(training: Path, test: Path) -> float:
    """How far joints are, metres, from the mean pose put where the middle of the body is seen."""
    mean = np.mean([pose - middle for middle, pose in poses(training)], axis=0)
    distances = [np.linalg.norm(middle + mean - pose, axis=-1) for middle, pose in poses(test)]
    return float(np.mean(distances))


def poses(recording: Path) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The middle of what is seen of each body, and its joints."""
    for frame in open_recording(recording):
        for body, joints in zip(
            frame.ground_truth.bodies, frame.ground_truth.positions, strict=True
        ):
            rows, columns = np.nonzero(frame.labels == body)
            points = back_project(columns, rows, frame.depth[rows, columns], frame.camera)
            yield np.median(points, axis=0), joints


def test_whole_demonstration_in_small(
    start_program: Callable[..., Program], tmp_path: Path
) -> None:
    code = (
        'import sys, lsc_pose_ros.demo as demo\n'
        'demo.TRAINING_FRAMES, demo.TEST_FRAMES, demo.ROOM_FRAMES = 300, 20, 10\n'
        f'sys.exit(demo.main(["--directory", {str(tmp_path / "demo")!r}]))'
    )
    program = start_program('-c', code)
    program.exit_status()
    assert re.search(r'estimated (19|20) of 20 frames over ROS 2', program.output), program.output
    folder = tmp_path / 'demo'
    assert re.search(r'found \d+ of 20 people', program.output), program.output
    assert (folder / 'room.png').stat().st_size > 10_000
    rows = re.findall(
        r'^(?:default|trained) model +([\d.]+) cm +([\d.]+) %$',
        program.output,
        re.MULTILINE,
    )
    assert len(rows) == 2, program.output
    # It has learned from a few people only, but more than how people stand on the average.
    baseline = error_of_the_mean_pose(folder / 'training.mcap', folder / 'test.mcap')
    assert float(rows[1][0]) < 70 * baseline, baseline
    own = load_model(folder / 'model.npz')
    assert own.joints.tolist() == load_model(default_model()).joints.tolist()
    assert (folder / 'live.png').stat().st_size > 10_000
    log = (folder / 'node.log').read_text()
    assert 'Traceback' not in log
    assert 'ERROR' not in log


def test_without_a_model_of_the_package_it_ends_with_a_reason(
    shipped: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
) -> None:
    assert shipped.is_dir()
    monkeypatch.setattr(demo, 'isolated_environment', dict)
    assert demo.main(['--directory', str(tmp_path / 'demo')]) == 2
    assert 'no model comes with this' in capfd.readouterr().err


def test_summary_compares_both_models(tmp_path: Path) -> None:
    scores = {'one': demo.ModelAccuracy(0.043, 0.951), 'other': demo.ModelAccuracy(0.061, 0.9)}
    room = demo.RoomResult(120, 93, 0.123)
    said = demo.summary(room, demo.LiveResult(20, 19, 0.05), scores, demo._files(tmp_path), 61.4)
    assert 'without a mask, the live node found 93 of 120 people' in said
    assert '12.3 cm' in said
    assert 'estimated 19 of 20 frames' in said
    assert 'as good as expected. The demonstration took 61 s' in said
    assert 'NOT' not in said
    assert re.search(r'^one +4\.3 cm +95\.1 %$', said, re.MULTILINE)
    assert re.search(r'^other +6\.1 cm +90\.0 %$', said, re.MULTILINE)
