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

"""The checks of labels: single joints, lag, left and right, and the report of a recording."""

import json
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.checks.mirroring import side_differences, side_report
from lsc_pose_ros.labels.checks.problems import (
    LIMBS,
    LabelLimits,
    behind_surface,
    find_problems,
    limb_lengths,
    near_mask,
    without_problems,
)
from lsc_pose_ros.labels.checks.timing import LabelledSequence, find_lag
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

HEIGHT, WIDTH = 240, 320
CAMERA = Intrinsics(285.63, 285.63, 159.0, 120.0)
STEP = 33_333_333


def naive_near_mask(
    positions: NDArray[np.float32], mask: NDArray[np.bool_], margin: int
) -> NDArray[np.bool_]:
    rows, columns = np.nonzero(mask)
    near = []
    for x, y, z in positions:
        if not (np.isfinite([x, y, z]).all() and z > 0):
            near.append(False)
            continue
        column = np.rint(np.float32(CAMERA.cx + CAMERA.fx * x / z))
        row = np.rint(np.float32(CAMERA.cy + CAMERA.fy * y / z))
        near.append(bool(((columns - column) ** 2 + (rows - row) ** 2 <= margin**2).any()))
    return np.array(near)


@pytest.mark.parametrize('margin', [0, 3])
def test_label_filter_measures_the_distance_to_the_mask(margin: int) -> None:
    random = np.random.default_rng(8)
    for _ in range(20):
        mask = random.random((HEIGHT, WIDTH)) < 0.01
        positions = random.uniform([-2, -1.5, 1], [2, 1.5, 3], (50, 3)).astype(np.float32)
        np.testing.assert_array_equal(
            near_mask(positions, mask, CAMERA, margin), naive_near_mask(positions, mask, margin)
        )


def test_label_filter_accepts_degenerate_labels() -> None:
    mask = np.ones((HEIGHT, WIDTH), bool)
    positions = np.array(
        [[0, 0, 2], [np.nan, 0, 2], [0, 0, 0], [0, 0, -1], [1e30, 0, 1], [0, np.inf, 1]],
        np.float32,
    )
    assert near_mask(positions, mask, CAMERA, 3).tolist() == [
        True,
        False,
        False,
        False,
        False,
        False,
    ]
    assert not near_mask(positions, np.zeros_like(mask), CAMERA, 3).any()


def naive_behind(positions, body, depth):
    behind = []
    for x, y, z in positions.tolist():
        value = np.nan
        if np.isfinite([x, y, z]).all() and z > 0:
            column = int(np.clip(np.rint(CAMERA.cx + CAMERA.fx * x / z), -1, 1e6))
            row = int(np.clip(np.rint(CAMERA.cy + CAMERA.fy * y / z), -1, 1e6))
            inside = 0 <= column < WIDTH and 0 <= row < HEIGHT
            if inside and body[row, column] and depth[row, column] > 0:
                value = z - depth[row, column]
        behind.append(value)
    return np.array(behind)


def test_distance_behind_the_surface():
    random = np.random.default_rng(2)
    depth = random.uniform(0.5, 3, (HEIGHT, WIDTH)).astype(np.float32)
    depth[random.random(depth.shape) < 0.2] = 0
    body = random.random(depth.shape) < 0.7
    positions = random.uniform([-2, -1.5, 1], [2, 1.5, 3], (200, 3)).astype(np.float32)
    strange = [
        [np.nan, 0, 2], [0, 0, 0], [0, 0, -1], [1e30, 0, 1], [0, np.inf, 1],
        [3e38, 3e38, 3e38],
    ]  # fmt: skip
    positions[:6] = np.array(strange, np.float32)
    frame = Frame(0, 'camera', depth, np.where(body, 1, NO_BODY), CAMERA, None)
    with np.errstate(over='ignore'):
        found = behind_surface(positions, body, frame)
    np.testing.assert_allclose(found, naive_behind(positions, body, depth), atol=1e-6)
    assert np.isfinite(found).sum() > 20


def standing(x=0.0):
    """A frame with a wall of a body at 2 m, and a skeleton 10 cm behind it."""
    depth = np.full((HEIGHT, WIDTH), 4, np.float32)
    labels = np.full((HEIGHT, WIDTH), NO_BODY, np.int32)
    depth[60:180, 100:220], labels[60:180, 100:220] = 2, 1
    positions = np.zeros((1, 20, 3), np.float32)
    positions[0] = x, 0, 2.1
    joints = np.arange(20, dtype=np.uint16)
    truth = Skeletons(np.array([1], np.uint16), joints, positions, np.ones((1, 20), np.float32))
    return Frame(0, 'camera', depth, labels, CAMERA, truth)


def test_problems_of_single_joints_and_their_removal():
    frame = standing()
    labels = frame.ground_truth
    labels.positions[0, 0] = 1.5, 0, 2.1  # off the mask
    labels.positions[0, 1, 2] = 1.9  # 10 cm before the surface
    labels.positions[0, 2, 2] = 2.7  # 70 cm behind it
    labels.positions[0, 3] = np.nan
    problems = find_problems(frame, labels)
    assert {kind: np.flatnonzero(joints[0]).tolist() for kind, joints in problems.items()} == {
        'outside': [0], 'before': [1], 'deep': [2], 'length': [],
    }  # fmt: skip
    loose = find_problems(frame, labels, LabelLimits(before=0.2, deep=1, margin=500))
    assert not any(joints.any() for joints in loose.values())
    cleaned = without_problems(labels, problems, ['outside', 'deep'])
    unknown = np.flatnonzero(np.isnan(cleaned.positions[0]).all(axis=1))
    assert unknown.tolist() == [0, 2, 3]
    assert cleaned.confidence[0, [0, 1, 2]].tolist() == [0, 1, 0]
    assert np.isfinite(labels.positions[0, 0]).all()


def test_limbs_that_change_their_length():
    frame = standing()
    labels = frame.ground_truth
    labels.positions[0] = np.random.default_rng(3).uniform(
        [-0.3, -0.3, 1.9], [0.3, 0.3, 2.5], (20, 3)
    )
    usual = limb_lengths(labels.positions[0])
    for (parent, child), length in zip(LIMBS, usual, strict=True):
        difference = labels.positions[0, child] - labels.positions[0, parent]
        assert length == pytest.approx(np.linalg.norm(difference), abs=1e-6)
    assert not find_problems(frame, labels, usual_lengths={1: usual})['length'].any()
    hand = JOINT_NUMBERS['l_hand']
    labels.positions[0, hand] += 1
    odd = find_problems(frame, labels, usual_lengths={1: usual})['length']
    assert np.flatnonzero(odd[0]).tolist() == [hand]
    assert not find_problems(frame, labels, usual_lengths={2: usual})['length'].any()


def waving(count, lag=0.0, noise=0.03, seed=0):
    """Labels that are `lag` frames early, and noisy estimates of another anatomy."""
    random = np.random.default_rng(seed)
    phases, directions = random.uniform(0, 6, 20), random.normal(0, 0.15, (20, 3))
    moments = np.arange(count)

    def at(times):
        return np.sin(times[:, None] / 5 + phases)[..., None] * directions

    anatomy = random.normal(0, 0.05, (20, 3))
    estimates = at(moments) + random.normal(0, noise, (count, 20, 3)) + anatomy
    return LabelledSequence(moments * STEP, at(moments + lag), estimates)


@pytest.mark.parametrize('lag', [-3, -1, 0, 2, 2.5, 5])
def test_lag_is_found_whatever_the_anatomy(lag):
    found = find_lag([waving(60, lag, seed=1), waving(40, lag, seed=2)])
    assert found.frames == pytest.approx(lag, abs=0.2)
    assert found.seconds == pytest.approx(lag / 30, abs=0.01)
    assert found.found == (lag != 0)


def test_lag_is_not_told_if_nothing_moves_or_labels_are_missing():
    still = waving(60)
    still = still._replace(
        estimates=np.zeros_like(still.estimates), labels=np.zeros_like(still.labels)
    )
    assert find_lag([still]) is None
    assert find_lag([]) is None
    assert find_lag([waving(8)]) is None
    sequence = waving(60)
    assert find_lag([sequence._replace(labels=np.full_like(sequence.labels, np.nan))]) is None
    sequence.labels[::7] = np.nan
    assert find_lag([sequence, waving(60, seed=4)]).frames == pytest.approx(0, abs=0.3)


def test_sides():
    random = np.random.default_rng(5)
    estimate = random.normal([0.5, 0, 2], 0.3, (20, 3))
    left = [JOINT_NUMBERS[name] for name in JOINT_NAMES if name.startswith('l_')]
    right = [JOINT_NUMBERS['r_' + JOINT_NAMES[number][2:]] for number in left]
    exchanged = estimate.copy()
    exchanged[left], exchanged[right] = estimate[right], estimate[left]
    mirrored = estimate * (-1, 1, 1)
    right_way = side_report([side_differences(estimate, estimate)])
    assert (right_way.exchanged, right_way.mirrored) == (0, 0)
    assert side_report([side_differences(exchanged, estimate)]).all_exchanged
    assert side_report([side_differences(mirrored, estimate)]).all_mirrored
    nothing = np.full((20, 3), np.nan)
    assert side_report([side_differences(nothing, estimate)]).bodies == 0


@pytest.fixture(scope='module')
def video():
    """Two people, each in a video of 40 frames; a second is between the videos."""
    settings = SyntheticSettings(frames=80, seed=7, clip_length=40, rate=30.0, yaw=20.0)
    frames = synthetic_frames(settings)
    return [
        frame._replace(stamp=frame.stamp + number // 40 * 10**9)
        for number, frame in enumerate(frames)
    ]


def checked(tmp_path, frames, *options):
    recording = tmp_path / 'labelled.mcap'
    with RecordingWriter(recording) as writer:
        for frame in frames:
            writer.write_frame(frame)
    results = tmp_path / 'check.json'
    assert main(['label', str(recording), '--json', str(results), *options]) == 0
    return json.loads(results.read_text())


def shifted(frames, lag):
    """Frames whose labels are those of `lag` frames later, within each video."""
    return [
        frame._replace(ground_truth=later.ground_truth)
        for frame, later in zip(frames, frames[lag:], strict=False)
        if later.stamp - frame.stamp < 10**9 * (lag + 0.5) / 30
    ]


def test_good_labels_pass(tmp_path, video, capsys):
    results = checked(tmp_path, video, '--report', str(tmp_path / 'page'))
    assert results['frames'] == 80
    assert not results['lag_found']
    assert results['exchanged'] < 0.1
    assert results['mirrored'] < 0.1
    assert results['problems']['outside'] < 0.02 * results['joints']
    assert results['problems']['length'] == 0
    page = (tmp_path / 'page' / 'index.html').read_text()
    assert 'Labels of labelled.mcap' in page
    assert 'joints' in capsys.readouterr().out


def test_lag_of_two_frames_is_found_and_corrected(tmp_path, video, capsys):
    late = shifted(video, 2)
    assert len(late) == 76
    results = checked(tmp_path, late)
    assert results['lag_found']
    assert results['lag_frames'] == pytest.approx(2, abs=0.5)
    assert '--time-offset' in results['advice'][0]
    output = tmp_path / 'corrected.mcap'
    words = ['--from', 'skeletons', '--correct-lag', '--drop', 'outside', 'before']
    assert main(['label', str(tmp_path / 'labelled.mcap'), '-o', str(output), *words]) == 0
    # The lag is that of all joints, whatever is dropped.
    assert f'shifted by {results["lag_seconds"]:+.3f} s' in capsys.readouterr().out
    true = {frame.stamp: frame.ground_truth.positions for frame in video}
    errors = [
        np.linalg.norm(frame.ground_truth.positions - true[frame.stamp], axis=-1)
        for frame in open_recording(output)
        if len(frame.ground_truth.bodies)
    ]
    assert len(errors) > 60
    before = [
        np.linalg.norm(frame.ground_truth.positions - true[frame.stamp], axis=-1) for frame in late
    ]
    assert np.nanmean(errors) < 0.4 * np.nanmean(before)


def test_exchanged_and_mirrored_labels_are_found_and_undone(tmp_path, video):
    def with_labels(change):
        return [
            frame._replace(
                ground_truth=frame.ground_truth._replace(
                    positions=change(frame.ground_truth.positions)
                )
            )
            for frame in video
        ]

    other = [
        JOINT_NUMBERS[{'l_': 'r_', 'r_': 'l_'}.get(name[:2], name[:2]) + name[2:]]
        for name in JOINT_NAMES
    ]
    results = checked(tmp_path, with_labels(lambda positions: positions[:, other]))
    assert results['exchanged'] > 0.8
    assert '--mirror names' in ' '.join(results['advice'])
    words = ['--from', 'skeletons', '--topic', '/ground_truth/skeletons', '--no-check']
    output = tmp_path / 'undone.mcap'
    source = str(tmp_path / 'labelled.mcap')
    assert main(['label', source, '-o', str(output), *words, '--mirror', 'names']) == 0
    for frame, true in zip(open_recording(output), video, strict=True):
        np.testing.assert_allclose(frame.ground_truth.positions, true.ground_truth.positions)


def test_mirrored_images_are_found(tmp_path, video):
    """A mirrored recording, as UTD-MHAD: images and x are mirrored, names are the person's own."""
    mirrored = []
    for frame in video:
        camera = frame.camera._replace(cx=frame.depth.shape[1] - 1 - frame.camera.cx)
        positions = frame.ground_truth.positions * np.array([-1, 1, 1], np.float32)
        mirrored.append(
            frame._replace(
                depth=np.ascontiguousarray(frame.depth[:, ::-1]),
                labels=np.ascontiguousarray(frame.labels[:, ::-1]),
                camera=camera,
                ground_truth=frame.ground_truth._replace(positions=positions),
            )
        )
    results = checked(tmp_path, mirrored)
    assert results['exchanged'] > 0.8
    assert 'mirror' in results['advice'][0]


def test_thresholds_drop_labels(tmp_path, video):
    hand = JOINT_NUMBERS['l_hand']
    frames = []
    for number, frame in enumerate(video[:20]):
        positions = frame.ground_truth.positions.copy()
        if number % 5 == 0:
            positions[:, hand] += (0, -1.2, 0)
        frames.append(
            frame._replace(ground_truth=frame.ground_truth._replace(positions=positions))
        )
    results = checked(tmp_path, frames)
    assert results['problems']['length'] == 4
    # Frames 5 and 10 are less than half a second from them.
    assert results['worst_frames'] == [0, 15]
    words = ['--from', 'skeletons', '--topic', '/ground_truth/skeletons', '--drop', 'length']
    output = tmp_path / 'clean.mcap'
    source = str(tmp_path / 'labelled.mcap')
    assert main(['label', source, '-o', str(output), *words]) == 0
    lost = [
        bool(np.isnan(frame.ground_truth.positions[0, hand]).all())
        for frame in open_recording(output)
    ]
    assert lost == [number % 5 == 0 for number in range(20)]


def test_a_recording_without_labels_cannot_be_checked(tmp_path, video, capsys):
    recording = tmp_path / 'plain.mcap'
    with RecordingWriter(recording) as writer:
        writer.write_frame(video[0]._replace(ground_truth=None))
    assert main(['label', str(recording), '--check']) == 2
    assert 'ground truth' in capsys.readouterr().err


def test_videos_of_these_tests_are_successive(video):
    steps = [after.stamp - before.stamp for before, after in pairwise(video)]
    assert [step > 4 * 10**7 for step in steps].count(True) == 1
