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

"""MSR-Action3D, in files that these tests write with a unit, a camera and a side of their own."""

from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros import open_recording
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.labels.sources.keypoints import DEPTH_BEHIND_SURFACE

FX, FY, CX, CY = 290.0, 285.0, 158.0, 121.0
UNIT = 0.0049
EPOCH = 1_420_070_400 * 10**9

# The bones of the data set's own figure (joints from 1): neck-head, arms, trunk, legs.
BONES = [
    (20, 3), (1, 3), (2, 3), (1, 8), (8, 10), (2, 9), (10, 12), (9, 11), (11, 13), (3, 4), (4, 7),
    (7, 5), (7, 6), (5, 14), (6, 15), (14, 16), (15, 17), (16, 18), (17, 19),
]  # fmt: skip


def standing(sequence: int, frame: int, *, first_hand: bool) -> np.ndarray:
    """A person at image centre, metres right, up and forward as the image shows it.

    The joints of the side that comes first in the files are at image left. One hand waves.
    """
    pose = {
        20: (0, 0.65), 3: (0, 0.45), 4: (0, 0.2), 7: (0, 0.0),
        1: (-0.2, 0.4), 8: (-0.25, 0.15), 10: (-0.28, -0.1), 12: (-0.28, -0.18),
        2: (0.2, 0.4), 9: (0.25, 0.15), 11: (0.28, -0.1), 13: (0.28, -0.18),
        5: (-0.1, -0.05), 14: (-0.11, -0.45), 16: (-0.12, -0.8), 18: (-0.12, -0.85),
        6: (0.1, -0.05), 15: (0.11, -0.45), 17: (0.12, -0.8), 19: (0.12, -0.85),
    }  # fmt: skip
    joints = np.array([(*pose[number], 2.6 + 0.02 * sequence) for number in range(1, 21)])
    hand = 11 if first_hand else 12
    joints[hand, :2] += (0.15 * np.sin(frame), 0.5 + 0.1 * np.cos(frame))
    return joints


def pixels_of(joints: np.ndarray) -> np.ndarray:
    x, y, z = joints.T
    return np.stack([CX + FX * x / z, CY - FY * y / z], axis=1)


def behind(number: int) -> float:
    names = {
        'head': (20,), 'neck': (3,), 'torso': (4,), 'pelvis': (7,), 'shoulder': (1, 2),
        'elbow': (8, 9), 'wrist': (10, 11), 'hand': (12, 13), 'hip': (5, 6), 'knee': (14, 15),
        'ankle': (16, 17), 'foot': (18, 19),
    }  # fmt: skip
    return next(DEPTH_BEHIND_SURFACE[name] for name, those in names.items() if number in those)


def depth_image(joints: np.ndarray) -> np.ndarray:
    """A disc around each joint, at the depth of the surface before it."""
    image = np.zeros((240, 320), np.int32)
    rows, columns = np.mgrid[:240, :320]
    for number in np.argsort(-joints[:, 2]) + 1:
        column, row = pixels_of(joints)[number - 1]
        inside = (columns - column) ** 2 + (rows - row) ** 2 < 49
        image[inside] = round((joints[number - 1, 2] - behind(number)) / UNIT)
    return image


def write_sequences(
    folder: Path, *, first_hand: bool = True, x_sign: int = 1, mirrored: bool = True
) -> dict[str, np.ndarray]:
    """Write sequences of two actions; return their joints as `standing` has them.

    Args:
        folder: where to write.
        first_hand: whether the hand that waves is of the joints that come first.
        x_sign: -1 if x points to image left.
        mirrored: whether the hand that waves is at image right.
    """
    flip = np.array([-1, 1, 1]) if first_hand == mirrored else np.ones(3)
    people: dict[str, np.ndarray] = {}
    for number, name in enumerate(('a01_s01_e01', 'a05_s02_e01', 'a10_s01_e02')):
        joints = np.stack([standing(number, f, first_hand=first_hand) * flip for f in range(5)])
        images = np.stack([depth_image(each) for each in joints])
        header = np.array([len(images), 320, 240], '<i4').tobytes()
        (folder / f'{name}_sdepth.bin').write_bytes(header + images.astype('<i4').tobytes())
        flat = (joints * (x_sign, 1, 1)).reshape(-1, 3)
        np.savetxt(folder / f'{name}_skeleton3D.txt', np.c_[flat, np.ones(len(flat))], '%.8f')
        pixels = np.concatenate([pixels_of(each) for each in joints])
        table = np.c_[pixels, flat[:, 2] / UNIT, np.ones(len(flat))]
        np.savetxt(folder / f'{name}_skeleton.txt', table, '%.6f')
        people[name] = joints
    return people


def imported(folder: Path, output: Path) -> list[Frame]:
    assert main(['import', 'msr-action3d', str(folder), str(output), '--no-check']) == 0
    return list(open_recording(output))


@pytest.mark.parametrize('first_hand', [True, False])
@pytest.mark.parametrize('x_sign', [1, -1])
@pytest.mark.parametrize('mirrored', [True, False])
def test_sides_axes_unit_and_camera(tmp_path, first_hand, x_sign, mirrored):
    people = write_sequences(tmp_path, first_hand=first_hand, x_sign=x_sign, mirrored=mirrored)
    frames = imported(tmp_path, tmp_path / 'msr.mcap')
    assert len(frames) == 15
    cx = 319 - CX if mirrored else CX
    np.testing.assert_allclose(frames[0].camera[:4], [FX, FY, cx, CY], rtol=1e-4)
    assert (frames[1].stamp - frames[0].stamp) == 10**9 // 15
    flip = -1 if mirrored else 1
    expected = np.concatenate(list(people.values())) * (flip, -1, 1)
    for frame, joints in zip(frames, expected, strict=True):
        truth = frame.ground_truth.positions[0]
        assert frame.ground_truth.bodies.tolist() == [1]
        hands = {True: 'r_hand', False: 'l_hand'}
        np.testing.assert_allclose(truth[JOINT_NUMBERS[hands[first_hand]]], joints[11], atol=1e-5)
        np.testing.assert_allclose(
            truth[JOINT_NUMBERS[hands[not first_hand]]], joints[12], atol=1e-5
        )
        np.testing.assert_allclose(truth[JOINT_NUMBERS['head']], joints[19], atol=1e-5)
        # The waving hand is the right one; of a person who faces the camera it is at image left.
        assert truth[JOINT_NUMBERS['r_hip'], 0] < truth[JOINT_NUMBERS['l_hip'], 0]
        # The hand is 2 cm behind its surface. Depths are whole units, of which the unit itself is
        # found by a median: one half of a unit.
        column, row = np.rint(project(truth[JOINT_NUMBERS['r_hand']], frame.camera)).astype(int)
        assert frame.depth[row, column] == pytest.approx(
            truth[JOINT_NUMBERS['r_hand'], 2] - DEPTH_BEHIND_SURFACE['hand'], abs=UNIT
        )
        assert frame.labels[row, column] == 1
        assert ((frame.labels == NO_BODY) == (frame.depth == 0)).all()


def test_joints_that_are_zero_are_unknown(tmp_path):
    write_sequences(tmp_path)
    path = tmp_path / 'a10_s01_e02_skeleton3D.txt'
    table = np.loadtxt(path)
    table[:20] = 0
    np.savetxt(path, table)
    frames = imported(tmp_path, tmp_path / 'msr.mcap')
    unknown = [not np.isfinite(frame.ground_truth.positions).any() for frame in frames]
    assert [number for number, each in enumerate(unknown) if each] == [10]


def test_what_cannot_be_used_is_told(tmp_path, capsys):
    def fails() -> str:
        assert main(['import', 'msr-action3d', str(tmp_path), str(tmp_path / 'o.mcap')]) == 2
        return capsys.readouterr().err

    assert 'no sequence of MSR-Action3D' in fails()
    write_sequences(tmp_path)
    depth = tmp_path / 'a01_s01_e01_sdepth.bin'
    data = depth.read_bytes()
    depth.write_bytes(data[:-4])
    assert 'need 1536012; fetch it again' in fails()
    depth.write_bytes(data[:8])
    assert 'has not the header' in fails()
    depth.write_bytes(np.array([1, 320, 240], '<i4').tobytes() + data[12 : 12 + 4 * 320 * 240])
    assert 'has 1 depth images, but' in fails()
    # The skeletons of another sequence: nothing fits.
    depth.write_bytes(data)
    pixels = tmp_path / 'a01_s01_e01_skeleton.txt'
    text = pixels.read_text()
    pixels.write_text(text[: text.index('\n', 3000)])
    assert 'a skeleton of MSR-Action3D is 20 lines of 4' in fails()
    pixels.write_text('\n'.join(text.splitlines()[:20]))
    assert 'fetch both again' in fails()
    assert not (tmp_path / 'o.mcap').exists()


def test_skeletons_of_other_images_are_refused(tmp_path, capsys):
    write_sequences(tmp_path)
    for path in tmp_path.glob('*_skeleton.txt'):
        table = np.loadtxt(path)
        random = np.random.default_rng(0)
        table[:, :2] += random.normal(0, 20, (len(table), 2))
        np.savetxt(path, table)
    assert main(['import', 'msr-action3d', str(tmp_path), str(tmp_path / 'o.mcap')]) == 2
    assert 'the skeletons do not fit the depth images' in capsys.readouterr().err


def test_sides_that_nothing_tells_are_refused(tmp_path, capsys):
    write_sequences(tmp_path)
    for path in tmp_path.glob('a0*'):
        path.unlink()
    assert main(['import', 'msr-action3d', str(tmp_path), str(tmp_path / 'o.mcap')]) == 2
    assert 'left and right cannot be told' in capsys.readouterr().err
