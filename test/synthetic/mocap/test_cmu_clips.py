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

"""Tests motion capture with clips of the CMU database, if they are installed."""

import numpy as np
import pytest
from captured_poses import angle, posed_joints

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_mesh import (
    pose_body,
)
from lsc_pose_ros.synthetic.geometry.rotations import from_quaternions
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.mocap import load_mocap
from lsc_pose_ros.synthetic.mocap.mocap_clip import read_clip
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS

CLIPS = ('01_01', '05_11', '07_01', '09_10', '13_18', '13_30', '14_23')


@pytest.fixture(scope='module')
def cmu(shared):
    folder = shared / 'mocap_cmu'
    if not folder.is_dir():
        pytest.skip(f'no motion capture in {folder}')
    return load_mocap(folder).only(CLIPS)


@pytest.fixture(scope='module')
def cmu_clips(cmu, shared):
    mapping = cmu._library._mapping
    return {name: read_clip(shared / 'mocap_cmu' / f'{name}.bvh', mapping) for name in CLIPS}


def hinge_bend(clip, upper, lower):
    """Return the signed flexion of a hinge, positive forwards, degrees."""
    orientations = from_quaternions(clip.orientations[clip.valid].astype(float))
    along = np.einsum(
        'tji,tj->ti',
        orientations[:, SEGMENTS.index(upper)],
        -orientations[:, SEGMENTS.index(lower), :, 1],
    )
    return np.degrees(np.arctan2(along[:, 2], -along[:, 1]))


def test_elbows_of_the_cmu_clips_bend_forwards(cmu_clips):
    for clip in cmu_clips.values():
        assert clip.valid.mean() > 0.4
        for side in ('l', 'r'):
            # Straight arms can be slightly bent backwards.
            elbow = hinge_bend(clip, f'{side}_upper_arm', f'{side}_forearm')
            assert elbow.min() > -20
            assert (elbow > -5).mean() > 0.75
            assert (hinge_bend(clip, f'{side}_thigh', f'{side}_shank') < 5).all()


def test_walking_people_of_the_cmu_clips_straighten_legs_and_arms(cmu_clips):
    walk = cmu_clips['07_01']
    for side in ('l', 'r'):
        knee = -hinge_bend(walk, f'{side}_thigh', f'{side}_shank')
        elbow = hinge_bend(walk, f'{side}_upper_arm', f'{side}_forearm')
        assert 0 <= knee.min() < 8
        assert 55 < knee.max() < 80
        assert 0 <= elbow.min() < 20


def test_directions_of_limbs_agree_with_the_cmu_files(cmu_clips, shared, body, rest):
    for name, clip in cmu_clips.items():
        joints = posed_joints(body, rest, clip)
        bvh = load_bvh(shared / 'mocap_cmu' / f'{name}.bvh')
        places = joint_poses(bvh).positions[1:]
        for letter in ('l', 'r'):
            for (start, end), (first, last) in (
                (('hip', 'knee'), ('Thigh', 'Shin')),
                (('shoulder', 'elbow'), ('Shldr', 'ForeArm')),
            ):
                ours = [joints[:, JOINT_NUMBERS[f'{letter}_{joint}']] for joint in (start, end)]
                theirs = [places[:, bvh.names.index(letter + joint)] for joint in (first, last)]
                assert angle(ours[1] - ours[0], theirs[1] - theirs[0]).max() < 2


@pytest.mark.parametrize('rate', [None, 30.0])
def test_motion_is_sampled_from_the_cmu_clips(cmu, body, rest, rate):
    motion = cmu.sample(body, rest, 40, rate, 0.5, np.random.default_rng(1))
    assert np.isfinite(motion.rotations).all()
    assert abs(motion.yaw).max() <= 0.5
    normalised = motion.rotations @ motion.rotations.swapaxes(-1, -2)
    np.testing.assert_allclose(normalised, np.broadcast_to(np.eye(3), normalised.shape), atol=1e-6)
    poses = [pose_body(body, rest, pose, np.zeros(3)).joints for pose in motion.rotations]
    body_yaw = (
        np.array(poses)[:, JOINT_NUMBERS['l_hip']] - np.array(poses)[:, JOINT_NUMBERS['r_hip']]
    )
    assert (body_yaw[:, 0] > 0).all()
