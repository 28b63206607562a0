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

"""Tests the motion of a clip: directions of limbs, corrections and valid frames."""

import numpy as np
import pytest
from captured_poses import AXES, angle, posed_joints, possible_pose, stand, turn

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.geometry.rotations import from_quaternions
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS

LIMBS = {
    'upper_arm': ('shoulder', 'elbow', 'arm', 'elbow'),
    'forearm': ('elbow', 'wrist', 'elbow', 'wrist'),
    'thigh': ('hip', 'knee', 'leg', 'knee'),
    'shank': ('knee', 'ankle', 'knee', 'ankle'),
}


@pytest.mark.parametrize(('up', 'forward'), AXES)
@pytest.mark.parametrize('order', ['ZXY', 'YXZ'])
def test_directions_of_limbs_agree_with_the_file(
    tmp_path, clip_of, body, rest, up, forward, order
):
    random = np.random.default_rng(8)
    # With one frame per second, this is not a jump.
    poses = [possible_pose(random) for _ in range(60)]
    clip = clip_of(poses, up, forward, order=order, frame_time=1.0)
    joints = posed_joints(body, rest, clip)
    bvh = load_bvh(tmp_path / 'clip.bvh')
    places = joint_poses(bvh).positions @ np.array(AXES[up, forward], float).T
    for side, letter in (('Left', 'l'), ('Right', 'r')):
        for start, end, first, last in LIMBS.values():
            ours = [joints[:, JOINT_NUMBERS[f'{letter}_{name}']] for name in (start, end)]
            theirs = [places[:, bvh.names.index(side + name)] for name in (first, last)]
            assert angle(ours[1] - ours[0], theirs[1] - theirs[0]).max() < 2


def test_left_and_up_agree_with_the_axes_of_the_mapping(clip_of, body, rest):
    pose = stand() | {'Leftarm': turn([0, 0, 1], 80)}
    joints = posed_joints(body, rest, clip_of([pose], 'z', '-y'))[0]
    assert joints[JOINT_NUMBERS['l_hand'], 1] > joints[JOINT_NUMBERS['head'], 1] + 0.2
    assert joints[JOINT_NUMBERS['r_hand'], 1] < joints[JOINT_NUMBERS['torso'], 1]
    assert joints[JOINT_NUMBERS['l_shoulder'], 0] > 0.1 > joints[JOINT_NUMBERS['r_shoulder'], 0]
    assert joints[JOINT_NUMBERS['l_foot'], 2] > joints[JOINT_NUMBERS['l_ankle'], 2] + 0.03


def test_trunk_and_head_rotate_as_captured(clip_of, body, rest):
    bow = stand() | {'Spine': turn([1, 0, 0], 40), 'Head': turn([0, 1, 0], 50)}
    clip = clip_of([bow])
    orientations = from_quaternions(clip.orientations[0].astype(float))
    chest = orientations[SEGMENTS.index('chest')]
    np.testing.assert_allclose(chest, turn([1, 0, 0], 40).as_matrix(), atol=1e-5)
    expected = (turn([1, 0, 0], 40) * turn([0, 1, 0], 50)).as_matrix()
    np.testing.assert_allclose(orientations[SEGMENTS.index('head')], expected, atol=1e-5)
    joints = posed_joints(body, rest, clip)[0]
    assert joints[JOINT_NUMBERS['head'], 2] > 0.2


def test_palm_at_the_thigh_is_kept(clip_of):
    clip = clip_of([stand()])
    hand = from_quaternions(clip.orientations[0].astype(float))[SEGMENTS.index('l_hand')]
    # Straight except for the 10 degrees by which the arm is raised.
    np.testing.assert_allclose(hand, turn([0, 0, 1], 10).as_matrix(), atol=1e-5)


def test_heading_is_separate_from_the_orientations(clip_of):
    degrees = np.arange(0, 400, 10)
    clip = clip_of([stand() | {'Hips': turn([0, 1, 0], value)} for value in degrees], 'z', 'x')
    np.testing.assert_allclose(np.degrees(clip.heading), degrees, atol=0.01)
    np.testing.assert_allclose(
        clip.orientations[1:], clip.orientations[:1].repeat(len(degrees) - 1, 0), atol=1e-5
    )


def test_wrong_axial_rotation_does_not_change_the_limb(clip_of):
    def bent(flip):
        # Half a turn about the upper arm, undone below: the joints do not move.
        elbow = turn([1, 0, 0], -flip) * turn([0, -1, 0], 60)
        return stand() | {
            'Leftarm': turn([0, 0, 1], -50) * turn([1, 0, 0], flip),
            'Leftelbow': elbow,
        }

    clip = clip_of([bent(0), bent(180), bent(90)], order='XYZ')
    arm = from_quaternions(clip.orientations.astype(float))[:, SEGMENTS.index('l_upper_arm')]
    np.testing.assert_allclose(arm[1:], arm[:1].repeat(2, 0), atol=1e-4)


@pytest.mark.parametrize('bent', ['', ', bent: 0'])
def test_clip_with_reversed_elbow_is_flipped(clip_of, body, rest, monkeypatch, bent):
    # With `bent`, the forearms of the figure are bent by 20 degrees in the neutral pose.
    crooked = 20 if bent else 0
    monkeypatch.setattr('stick_figure.CROOKED', np.radians(crooked))
    monkeypatch.setattr('stick_figure.BENT', bent)
    right = [stand() | {'Leftelbow': turn([0, -1, 0], 50 + number)} for number in range(20)]
    wrong = [stand() | {'Leftelbow': turn([0, 1, 0], 50 + number)} for number in range(20)]
    expected = posed_joints(body, rest, clip_of(right))
    found = posed_joints(body, rest, clip_of(wrong))
    for name in ('l_elbow', 'l_wrist', 'l_hand'):
        number = JOINT_NUMBERS[name]
        np.testing.assert_allclose(found[:, number], expected[:, number], atol=0.01)


def test_constant_error_of_the_axial_rotation_is_removed_from_straight_arms(clip_of):
    def arm(error, elbow):
        # The error is undone at the elbow, so the joints do not move.
        return stand() | {
            'Leftarm': turn([0, 0, 1], -50) * turn([1, 0, 0], error),
            'Leftelbow': turn([1, 0, 0], -error) * turn([0, -1, 0], elbow),
        }

    straight = [
        from_quaternions(
            clip_of([*[arm(error, 70)] * 20, arm(error, 0)]).orientations[-1].astype(float)
        )
        for error in (0, 40)
    ]
    number = SEGMENTS.index('l_upper_arm')
    np.testing.assert_allclose(straight[1][number], straight[0][number], atol=1e-3)


def test_impossible_frames_are_not_valid(clip_of):
    frames = [stand() for _ in range(30)]
    frames[10] = stand() | {'Leftknee': turn([1, 0, 0], -80)}
    valid = clip_of(frames).valid
    # The steps to its neighbours are jumps.
    np.testing.assert_array_equal(np.flatnonzero(~valid), [9, 10, 11])


def test_file_without_valid_frames_is_refused(clip_of):
    with pytest.raises(InputError, match=r'clip.bvh: with the mapping .*map.yaml no frame'):
        clip_of([stand() | {'Leftknee': turn([1, 0, 0], -80)}])


@pytest.mark.parametrize(('bent', 'degrees'), [('', 20), (', bent: 0', 0), (', bent: 10', 10)])
def test_bent_removes_the_excess_flexion_of_the_file(clip_of, monkeypatch, bent, degrees):
    monkeypatch.setattr('stick_figure.CROOKED', np.radians(20))
    monkeypatch.setattr('stick_figure.BENT', bent)
    orientations = from_quaternions(clip_of([stand()]).orientations[0].astype(float))
    upper, lower = (orientations[SEGMENTS.index(name)] for name in ('l_upper_arm', 'l_forearm'))
    assert angle(upper[:, 1], lower[:, 1]) == pytest.approx(degrees, abs=0.01)


def test_neutral_frame_replaces_the_pose_without_rotations(clip_of):
    # The same figure, but its rotations are 0 in a lying person.
    up = turn([1, 0, 0], 90)
    pose = stand() | {'Spine': turn([1, 0, 0], 20)}
    frames = [{'Hips': up}, pose | {'Hips': up}]
    expected = clip_of([pose]).orientations
    found = clip_of(frames, extra='neutral: 0\nskip: 1\n', order='YZX')
    # The neutral frame includes this pose, so only the trunk can be compared.
    for name in ('pelvis', 'chest', 'head'):
        number = SEGMENTS.index(name)
        np.testing.assert_allclose(
            abs(found.orientations[0, number]), abs(expected[0, number]), atol=1e-5
        )


def test_files_with_high_rates_are_subsampled_to_at_least_30_hz(clip_of):
    assert clip_of([stand()] * 12, frame_time=1 / 120).rate == pytest.approx(30, rel=1e-3)
    assert len(clip_of([stand()] * 12, frame_time=1 / 120).orientations) == 3
    assert clip_of([stand()] * 12, frame_time=1 / 50).rate == pytest.approx(50, rel=1e-3)


def test_missing_joints_and_frames_are_reported(clip_of):
    with pytest.raises(InputError, match=r'2 frames; the mapping .* needs 6'):
        clip_of([stand()] * 2, extra='skip: 5\n')
    with pytest.raises(InputError, match='no joint Nose, which the mapping'):
        clip_of([stand()], extra='  neck: {turns: Nose}\n')
