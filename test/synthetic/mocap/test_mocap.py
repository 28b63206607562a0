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

"""Tests the sampling of poses and motion from clips."""

import numpy as np
import pytest
from captured_poses import stand, turn
from scipy.spatial.transform import Rotation
from stick_figure import bvh_text, mapping_text

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_mesh import (
    pose_body,
)
from lsc_pose_ros.synthetic.mocap.mocap import load_mocap


def waving(frames, arm='Leftarm', speed=6):
    return [stand() | {arm: turn([0, 0, 1], -80 + speed * number)} for number in range(frames)]


@pytest.fixture
def folder(tmp_path):
    clips = {
        'a/left': waving(25),
        'a/right': [pose | {'Leftarm': turn([0, 0, 1], -80)} for pose in waving(25, 'Rightarm')],
        'still': [stand()] * 300,
        'turning': [stand() | {'Hips': turn([0, 1, 0], 3 * number)} for number in range(90)],
    }
    (tmp_path / 'a').mkdir()
    for name, frames in clips.items():
        (tmp_path / f'{name}.bvh').write_text(bvh_text(frames), encoding='ascii')
    (tmp_path / 'a' / 'left.bvh').rename(tmp_path / 'a' / 'left.BVH')
    (tmp_path / 'map.yaml').write_text(mapping_text(), encoding='ascii')
    return tmp_path


def test_clips_are_selected_by_name(folder):
    mocap = load_mocap(folder, folder / 'map.yaml')
    assert mocap.clips == ('a/left', 'a/right', 'still', 'turning')
    assert mocap.only(['a/*', 'still']).clips == ('a/left', 'a/right', 'still')
    assert mocap.without(['a/*']).clips == ('still', 'turning')
    with pytest.raises(InputError, match='b/\\* matches none of the 4 clips'):
        mocap.only(['still', 'b/*'])
    with pytest.raises(InputError, match='exclude fewer'):
        mocap.without(['*'])


def test_folder_without_clips_is_refused(tmp_path):
    with pytest.raises(InputError, match='no BVH file'):
        load_mocap(tmp_path)
    with pytest.raises(InputError, match='no BVH file'):
        load_mocap(tmp_path / 'nowhere')


def test_clips_are_read_only_when_needed(folder, body, rest):
    (folder / 'still.bvh').write_text('NONSENSE', encoding='ascii')
    mocap = load_mocap(folder, folder / 'map.yaml')
    mocap.without(['still']).sample(body, rest, 3, None, 1.0, np.random.default_rng(1))
    with pytest.raises(InputError, match=r'still.bvh, line 1'):
        mocap.only(['still']).sample(body, rest, 3, None, 1.0, np.random.default_rng(1))


@pytest.mark.parametrize('rate', [None, 24.0])
def test_motion_depends_only_on_the_seed(folder, body, rest, rate):
    def sample(seed):
        mocap = load_mocap(folder, folder / 'map.yaml').only(['a/*'])
        return mocap.sample(body, rest, 12, rate, 1.0, np.random.default_rng(seed))

    first, again, other = sample(4), sample(4), sample(5)
    assert first.rotations.shape == (12, len(body.bones), 3, 3)
    np.testing.assert_array_equal(first.rotations, again.rotations)
    np.testing.assert_array_equal(first.yaw, again.yaw)
    assert abs(first.rotations - other.rotations).max() > 0.01


def test_standing_still_does_not_dominate(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml')
    motion = mocap.sample(body, rest, 60, None, 1.0, np.random.default_rng(2))
    still = abs(motion.rotations - motion.rotations[:, None]).max(axis=(2, 3, 4)) < 1e-3
    assert still.mean() < 0.2  # 300 of 440 frames are still, in 90 the person only turns around


def test_section_keeps_the_speed_of_the_clip(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml').only(['a/left'])
    motion = mocap.sample(body, rest, 30, 60.0, np.pi, np.random.default_rng(6))
    bone = list(body.bones).index('upperarm02.L')
    speeds = []
    for before, after in zip(motion.rotations[:-1], motion.rotations[1:], strict=True):
        ours = [
            pose_body(body, rest, pose, np.zeros(3)).orientations[bone] for pose in (before, after)
        ]
        speeds.append(Rotation.from_matrix(ours[0].T @ ours[1]).magnitude())
    np.testing.assert_allclose(np.degrees(speeds), 3, atol=0.2)  # 6 degrees per frame at 30 Hz


def test_motion_longer_than_its_clips_has_no_jumps(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml').only(['a/*'])
    motion = mocap.sample(body, rest, 300, 30.0, 1.0, np.random.default_rng(7))
    joints = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).joints for pose in motion.rotations]
    )
    assert len(joints) == 300
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() < 0.3
    assert abs(np.diff(motion.yaw)).max() < 0.05
