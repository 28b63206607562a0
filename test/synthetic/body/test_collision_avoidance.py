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

"""Tests that limbs that penetrate the body are moved out of it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    RestBody,
    forward_kinematics,
    relative_rotations,
    shape_body,
    standing_orientations,
)
from lsc_pose_ros.synthetic.body.bone_rotations import rig_of
from lsc_pose_ros.synthetic.body.collision_avoidance import (
    nearest_points,
    resolve_collisions,
    rotation_about,
)
from lsc_pose_ros.synthetic.body.self_collision import MAX_PENETRATION, fit_capsules


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


@pytest.fixture(scope='module')
def stout(body: BodyModel) -> RestBody:
    body_shape = BodyShape(50, 1.0, weight=1.0, muscle=0.4, measures={'belly': 0.6})
    return shape_body(body, body_shape)


def pose(body, rest, degrees, elbow=0.0):
    """Return hanging arms, rotated by `degrees` outwards or, if negative, into the body."""
    orientations = standing_orientations(body, rest)
    for number, name in enumerate(body.bones):
        arm = name.startswith(('upperarm', 'lowerarm', 'wrist', 'finger', 'metacarpal'))
        if arm and name.endswith(('.L', '.R')):
            sign = 1 if name.endswith('.L') else -1
            out = Rotation.from_euler('z', sign * degrees, degrees=True)
            bend = Rotation.from_euler(
                'x', 0 if name.startswith('upper') else -elbow, degrees=True
            )
            orientations[number] = (out * bend).as_matrix() @ orientations[number]
    return relative_rotations(body, orientations)


def deepest(body, rest, rotations):
    """Return how far arms penetrate trunk or legs, metres, by sampling the capsules' axes."""
    capsules = fit_capsules(body, rest, rig_of(body, rest))
    orientations, heads = forward_kinematics(rotations, body.parents, rest.heads)
    fractions = np.linspace(0, 1, 60)[:, None]
    axes = []
    for bone, ends in zip(capsules.bones, capsules.ends, strict=True):
        start, end = heads[bone] + ends @ orientations[bone].T
        axes.append(start + fractions * (end - start))
    depths = []
    for (one, other), allowed in zip(capsules.pairs, capsules.allowed, strict=True):
        names = {capsules.names[one][2:], capsules.names[other][2:]}
        if names & {'forearm', 'hand', 'fingers'} and not names & {'upper_arm'}:
            apart = np.linalg.norm(axes[one][:, None] - axes[other], axis=-1).min()
            depths.append(capsules.radii[[one, other]].sum() - apart - allowed)
    return max(depths)


@pytest.mark.parametrize(('degrees', 'elbow'), [(-12, 0), (-20, 0), (-12, 60)])
def test_arms_are_moved_out_of_the_body(body, stout, degrees, elbow):
    rotations = pose(body, stout, degrees, elbow)[None]
    assert deepest(body, stout, rotations[0]) > MAX_PENETRATION + 0.02
    assert (
        deepest(body, stout, resolve_collisions(body, stout, rotations)[0])
        < MAX_PENETRATION + 0.003
    )


def test_poses_without_collision_stay_unchanged(body, stout):
    rotations = pose(body, stout, 40)[None].repeat(3, axis=0)
    kept = rotations.copy()
    np.testing.assert_array_equal(resolve_collisions(body, stout, rotations), kept)
    np.testing.assert_allclose(
        resolve_collisions(body, stout, rotations, spread=2), kept, atol=1e-12
    )


def test_only_the_colliding_limb_moves_and_the_input_stays_unchanged(body, stout):
    rotations = pose(body, stout, -20)[None]
    kept = rotations.copy()
    resolved = resolve_collisions(body, stout, rotations)
    np.testing.assert_array_equal(rotations, kept)
    moved = {str(body.bones[n]) for n in np.flatnonzero((resolved != kept).any(axis=(0, 2, 3)))}
    assert moved == {'upperarm01.L', 'upperarm01.R'}


def test_corrections_are_smooth_over_time(body, stout):
    degrees = [30] * 10 + [-15] * 10 + [30] * 10
    rotations = np.array([pose(body, stout, value) for value in degrees])
    bone = list(body.bones).index('upperarm01.L')

    def corrections(spread):
        resolved = resolve_collisions(body, stout, rotations, spread=spread)[:, bone]
        orientations = resolved @ rotations[:, bone].transpose(0, 2, 1)
        return np.degrees(Rotation.from_matrix(orientations).magnitude())

    sudden, smooth = corrections(0), corrections(6)
    assert abs(np.diff(sudden)).max() > 5
    assert abs(np.diff(smooth)).max() < 0.3 * abs(np.diff(sudden)).max()


def test_nearest_points_agree_with_sampling():
    random = np.random.default_rng(2)
    fractions = np.linspace(0, 1, 401)[:, None]
    for number in range(60):
        one, other = random.normal(size=(2, 2, 3))
        if number % 4 == 1:
            one[1] = one[0]
        if number % 4 == 2:
            other[1] = other[0] + 2 * (one[1] - one[0])  # parallel
        if number % 8 == 3:
            one[1], other[1] = one[0], other[0]
        found = nearest_points(one, other)
        first = one[0] + fractions * (one[1] - one[0])
        second = other[0] + fractions * (other[1] - other[0])
        least = np.linalg.norm(first[:, None] - second, axis=-1).min()
        gap = np.linalg.norm(found[0] - found[1])
        assert gap <= least + 1e-9
        assert gap == pytest.approx(least, abs=0.01)


def test_rotation_about_agrees_with_scipy():
    random = np.random.default_rng(4)
    for _ in range(20):
        axis = random.normal(size=3)
        axis /= np.linalg.norm(axis)
        angle = random.uniform(-4, 4)
        expected = Rotation.from_rotvec(angle * axis).as_matrix()
        np.testing.assert_allclose(rotation_about(axis, angle), expected, atol=1e-12)
