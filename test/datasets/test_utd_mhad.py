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

"""Tests the import of UTD-MHAD: mirroring, lag, label filter, selection, errors, real data."""

import argparse
import builtins
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.cli.commands import import_command
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.datasets.utd_mhad import (
    CAMERA,
    KINECT_ORDER,
    LAG,
    Selection,
    import_utd_mhad,
    select_sequences,
)
from lsc_pose_ros.datasets.utd_mhad_files import ActionSequence
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.checks.problems import near_mask
from lsc_pose_ros.labels.vocabulary import load_vocabulary

HEIGHT, WIDTH = 240, 320
DISTANCE = 2.5


def write_sequence(
    folder: Path,
    action: int,
    subject: int,
    trial: int,
    length: int = 5,
    *,
    skeleton_length: int | None = None,
) -> None:
    """Write a sequence whose depth image k is (1000 + k) mm in its right half.

    Joint j of skeleton k is at (0.01 j, 0.02 j, 2.5 + 0.001 k), in the data set's own axes.
    """
    scipy_io = pytest.importorskip('scipy.io')
    for name in ('Depth', 'Skeleton'):
        (folder / name).mkdir(exist_ok=True)
    depth = np.zeros((HEIGHT, WIDTH, length), np.uint16)
    depth[:, WIDTH // 2 :] = 1000 + np.arange(length)
    joints = np.arange(20.0)
    skeleton_length = length if skeleton_length is None else skeleton_length
    skeleton = np.empty((20, 3, skeleton_length))
    skeleton[:, 0] = 0.01 * joints[:, None]
    skeleton[:, 1] = 0.02 * joints[:, None]
    skeleton[:, 2] = DISTANCE + 0.001 * np.arange(skeleton_length)
    stem = f'a{action}_s{subject}_t{trial}'
    scipy_io.savemat(folder / 'Depth' / f'{stem}_depth.mat', {'d_depth': depth})
    scipy_io.savemat(folder / 'Skeleton' / f'{stem}_skeleton.mat', {'d_skel': skeleton})


@pytest.fixture
def small(tmp_path: Path) -> Path:
    for action, subject, trial in ((1, 1, 1), (10, 1, 1), (2, 1, 2), (1, 2, 1)):
        write_sequence(tmp_path, action, subject, trial)
    return tmp_path


def stems(sequences: list[ActionSequence]) -> list[str]:
    return [sequence.depth_path.name.removesuffix('_depth.mat') for sequence in sequences]


def test_sequences_are_sorted_by_subject_action_and_trial(small: Path) -> None:
    sequences = select_sequences(small, Selection())
    assert stems(sequences) == ['a1_s1_t1', 'a2_s1_t2', 'a10_s1_t1', 'a1_s2_t1']


@pytest.mark.parametrize(
    ('selection', 'expected'),
    [
        (Selection(subjects=[2]), ['a1_s2_t1']),
        (Selection(actions=[2, 10]), ['a2_s1_t2', 'a10_s1_t1']),
        (Selection(trials=[2]), ['a2_s1_t2']),
        (Selection(subjects=[1], actions=[1]), ['a1_s1_t1']),
    ],
)
def test_selection_finds_the_named_sequences(
    small: Path, selection: Selection, expected: list[str]
) -> None:
    assert stems(select_sequences(small, selection)) == expected


def test_image_and_positions_are_unmirrored(small: Path) -> None:
    frame = next(import_utd_mhad(select_sequences(small, Selection()), label_filter=False))
    assert frame.depth.shape == (HEIGHT, WIDTH)
    assert frame.depth.dtype == np.float32
    assert (frame.depth[:, : WIDTH // 2] == np.float32(1.002)).all()
    assert (frame.depth[:, WIDTH // 2 :] == 0).all()
    expected = np.empty((20, 3))
    names = load_vocabulary('kinect_v1').joints
    theirs = {next(iter(source.weights)): name for name, source in names.items()}
    for index, name in enumerate(KINECT_ORDER):
        expected[JOINT_NUMBERS[theirs[name]]] = (-0.01 * index, -0.02 * index, DISTANCE)
    np.testing.assert_allclose(frame.ground_truth.positions[0], expected, atol=1e-6)
    assert frame.camera == Intrinsics(285.63, 285.63, 159.0, 120.0)
    assert frame.frame_id == 'camera_depth_optical_frame'


def test_depth_is_paired_with_the_skeleton_of_two_frames_before(small: Path) -> None:
    frames = list(import_utd_mhad(select_sequences(small, Selection(subjects=[2]))))
    assert LAG == 2
    assert len(frames) == 3
    for index, frame in enumerate(frames):
        assert frame.depth.max() == np.float32((1002 + index) / 1000)
        head = frame.ground_truth.positions[0, JOINT_NUMBERS['head']]
        assert head[2] == pytest.approx(DISTANCE + 0.001 * index, abs=1e-6)


def test_labels_are_body_one_where_there_is_depth(small: Path) -> None:
    frame = next(import_utd_mhad(select_sequences(small, Selection())))
    assert frame.labels.dtype == np.int32
    np.testing.assert_array_equal(frame.labels, np.where(frame.depth > 0, 1, NO_BODY))
    assert frame.ground_truth.bodies.tolist() == [1]
    assert frame.ground_truth.joints.tolist() == list(range(20))


def test_stamps_are_thirty_hertz_with_a_gap_between_sequences(small: Path) -> None:
    stamps = np.array(
        [frame.stamp for frame in import_utd_mhad(select_sequences(small, Selection()))]
    )
    steps = np.diff(stamps)
    inside = np.ones(len(steps), bool)
    inside[2::3] = False
    np.testing.assert_allclose(steps[inside], 1e9 / 30, atol=1)
    assert (steps[~inside] > 10**9).all()


def test_stamps_do_not_depend_on_the_number_of_sampled_frames(small: Path) -> None:
    every = {frame.stamp for frame in import_utd_mhad(select_sequences(small, Selection()))}
    some = select_sequences(small, Selection(max_frames=5, seed=3))
    assert {frame.stamp for frame in import_utd_mhad(some)} <= every


def test_stride_keeps_every_nth_frame(small: Path) -> None:
    sequences = select_sequences(small, Selection(stride=2))
    assert [sequence.frames.tolist() for sequence in sequences] == [[2, 4]] * 4


def test_sampled_frames_are_distinct_evenly_spread_and_repeatable(tmp_path: Path) -> None:
    for trial in (1, 2, 3):
        write_sequence(tmp_path, 1, 1, trial, length=42)
    selection = Selection(max_frames=30, seed=5)
    sequences = select_sequences(tmp_path, selection)
    again = select_sequences(tmp_path, selection)
    assert [sequence.frames.tolist() for sequence in sequences] == [
        sequence.frames.tolist() for sequence in again
    ]
    assert [len(sequence.frames) for sequence in sequences] == [10, 10, 10]
    for sequence in sequences:
        assert sequence.frames.min() >= LAG
        assert sequence.frames.max() < 42
        assert (np.diff(sequence.frames) > 0).all()
    other = select_sequences(tmp_path, selection._replace(seed=6))
    assert [sequence.frames.tolist() for sequence in sequences] != [
        sequence.frames.tolist() for sequence in other
    ]


def test_sampling_more_frames_than_available_keeps_all(small: Path) -> None:
    sequences = select_sequences(small, Selection(max_frames=1000))
    assert sum(len(sequence.frames) for sequence in sequences) == 12


def test_joints_off_the_mask_are_unlabelled_unless_the_filter_is_off(small: Path) -> None:
    sequences = select_sequences(small, Selection())
    filtered = next(import_utd_mhad(sequences)).ground_truth
    kept = next(import_utd_mhad(sequences, label_filter=False)).ground_truth
    # The mask is the left half; the joints go from column 159 to the left, the last ones above
    # the image.
    assert np.isfinite(kept.positions).all()
    assert (kept.confidence == 1).all()
    gone = np.isnan(filtered.positions[0]).all(axis=1)
    rows = project(kept.positions[0], CAMERA)[:, 1]
    np.testing.assert_array_equal(gone, rows < -3)
    np.testing.assert_array_equal(filtered.confidence[0], np.where(gone, 0, 1))


@pytest.mark.parametrize(
    ('selection', 'words'),
    [
        (Selection(subjects=[9]), 'no sequence of subject 9; it has 1, 2'),
        (Selection(actions=[3]), 'no sequence of action 3'),
        (Selection(trials=[4]), 'no sequence of trial 4'),
        (Selection(subjects=[2], trials=[2]), 'no sequence in .* has this subject'),
        (Selection(stride=0), 'stride is 0'),
        (Selection(max_frames=0), 'number of frames is 0'),
        (Selection(seed=-1), 'seed is -1'),
    ],
)
def test_impossible_selection_is_refused(small: Path, selection: Selection, words: str) -> None:
    with pytest.raises(InputError, match=words):
        select_sequences(small, selection)


def test_folder_that_is_not_utd_mhad_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'there is no folder .*nowhere.* Depth and Skeleton'):
        select_sequences(tmp_path / 'nowhere', Selection())
    with pytest.raises(InputError, match='no folder Depth and no folder Skeleton'):
        select_sequences(tmp_path, Selection())
    (tmp_path / 'Depth').mkdir()
    with pytest.raises(InputError, match='has no folder Skeleton;'):
        select_sequences(tmp_path, Selection())
    (tmp_path / 'Skeleton').mkdir()
    with pytest.raises(InputError, match=r'has no file aA_sS_tT_depth\.mat'):
        select_sequences(tmp_path, Selection())


def test_sequences_too_short_for_the_lag_are_refused(tmp_path: Path) -> None:
    write_sequence(tmp_path, 1, 1, 1, length=2)
    with pytest.raises(InputError, match='longer than 2 frames'):
        select_sequences(tmp_path, Selection())


def test_missing_skeleton_file_is_refused(small: Path) -> None:
    (small / 'Skeleton' / 'a1_s1_t1_skeleton.mat').unlink()
    with pytest.raises(InputError, match=r'a1_s1_t1_skeleton\.mat is missing'):
        select_sequences(small, Selection())


def test_file_without_its_key_is_refused(small: Path) -> None:
    scipy_io = pytest.importorskip('scipy.io')
    scipy_io.savemat(small / 'Depth' / 'a1_s1_t1_depth.mat', {'other': np.zeros(3)})
    sequences = select_sequences(small, Selection())
    with pytest.raises(InputError, match='has no array d_depth'):
        next(import_utd_mhad(sequences))


def test_damaged_file_is_refused(small: Path) -> None:
    path = small / 'Depth' / 'a1_s1_t1_depth.mat'
    sequences = select_sequences(small, Selection())
    whole = path.read_bytes()
    for damaged in (b'', b'no mat file at all', whole[:200], whole[: len(whole) // 2]):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r'cannot be read as a \.mat file'):
            next(import_utd_mhad(sequences))


def test_depth_and_skeletons_of_different_length_are_refused(tmp_path: Path) -> None:
    write_sequence(tmp_path, 1, 1, 1, length=5, skeleton_length=6)
    with pytest.raises(InputError, match=r'\(240, 320, 5\).* 6 frames'):
        next(import_utd_mhad(select_sequences(tmp_path, Selection())))


def test_skeletons_of_another_shape_are_refused(small: Path) -> None:
    scipy_io = pytest.importorskip('scipy.io')
    path = small / 'Skeleton' / 'a1_s1_t1_skeleton.mat'
    scipy_io.savemat(path, {'d_skel': np.zeros((15, 3, 5))})
    with pytest.raises(InputError, match=r'\(15, 3, 5\), not \(20, 3, T\)'):
        select_sequences(small, Selection())


def test_missing_scipy_is_reported_with_the_way_to_install_it(
    small: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    true_import = builtins.__import__

    def without_scipy(name: str, *arguments: Any, **keywords: Any) -> Any:
        if name.startswith('scipy'):
            raise ImportError(name)
        return true_import(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, '__import__', without_scipy)
    with pytest.raises(InputError, match='pip install scipy, or as python3-scipy'):
        select_sequences(small, Selection())


def run_command(*words: object) -> int:
    parser = argparse.ArgumentParser()
    import_command.add_arguments(parser)
    return import_command.run(parser.parse_args([str(word) for word in words]))


def test_command_writes_a_labelled_recording(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'out.mcap'
    assert run_command('utd-mhad', small, output, '--subjects', 1, '--no-label-filter') == 0
    assert '9 frames of 3 sequences' in capsys.readouterr().out
    sequences = select_sequences(small, Selection(subjects=[1]))
    expected = list(import_utd_mhad(sequences, label_filter=False))
    read = list(open_recording(output))
    assert [frame.stamp for frame in read] == [frame.stamp for frame in expected]
    for frame, original in zip(read, expected, strict=True):
        np.testing.assert_allclose(frame.depth, original.depth, atol=1e-6)
        np.testing.assert_array_equal(frame.labels, original.labels)
        np.testing.assert_array_equal(
            frame.ground_truth.positions, original.ground_truth.positions
        )
        assert frame.camera == pytest.approx(original.camera)


def test_help_states_the_three_corrections(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run_command('utd-mhad', '--help')
    text = capsys.readouterr().out
    for words in ('flipped left-right', '2 frames ahead', '3 pixels outside of the mask'):
        assert words in text


def test_joints_are_in_the_real_masks_as_often_as_measured(shared: Path) -> None:
    """These fractions require the right mirroring, intrinsics, lag and joint order."""
    pytest.importorskip('scipy')
    sequences = select_sequences(shared / 'utd_mhad', Selection(trials=[1, 3], max_frames=300))
    inside, near = [], []
    for frame in import_utd_mhad(sequences, label_filter=False):
        mask = frame.depth > 0
        inside.append(near_mask(frame.ground_truth.positions[0], mask, CAMERA, 0))
        near.append(near_mask(frame.ground_truth.positions[0], mask, CAMERA, 3))
    fraction = dict(zip(JOINT_NAMES, np.mean(inside, axis=0), strict=True))
    assert fraction['r_hand'] == pytest.approx(0.76, abs=0.08)
    assert np.mean(near, axis=0)[JOINT_NUMBERS['r_hand']] == pytest.approx(0.93, abs=0.04)
    assert fraction['r_wrist'] == pytest.approx(0.90, abs=0.06)
    assert fraction['l_elbow'] == pytest.approx(0.97, abs=0.03)
    for name in ('head', 'neck', 'torso', 'pelvis', 'l_hip', 'r_hip', 'l_knee', 'r_knee'):
        assert fraction[name] > 0.98


def test_right_hand_waves_at_image_left_in_the_real_data(shared: Path) -> None:
    """Action 3 waves the right hand, so the arm that moves must be the right one."""
    pytest.importorskip('scipy')
    sequences = select_sequences(
        shared / 'utd_mhad', Selection(subjects=[1], actions=[3], trials=[1])
    )
    right, left = JOINT_NUMBERS['r_hand'], JOINT_NUMBERS['l_hand']
    heights = []
    for frame in import_utd_mhad(sequences, label_filter=False):
        positions = frame.ground_truth.positions[0]
        assert positions[right, 0] < positions[left, 0]
        heights.append(positions[[right, left], 1])
    lifted = np.ptp(np.array(heights), axis=0)
    assert lifted[0] > 0.3
    assert lifted[1] < 0.1


def test_real_subjects_have_the_documented_number_of_sequences(shared: Path) -> None:
    pytest.importorskip('scipy')
    sequences = select_sequences(shared / 'utd_mhad', Selection())
    assert len(sequences) == 646
    assert sum(sequence.skeletons.shape[2] for sequence in sequences) == 43_314
