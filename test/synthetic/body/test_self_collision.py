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

"""Tests the capsules and the detection of self-collisions."""

import numpy as np
import pytest

from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import BodyShape, pose_body, shape_body
from lsc_pose_ros.synthetic.body.bone_rotations import pose_rotations
from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    deepest_penetration,
    fit_collision_body,
    mean_distances,
    segment_distance,
)
from lsc_pose_ros.synthetic.motion.inverse_kinematics import REACH_TOLERANCE, solve_arm
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ANGLES, ARMS

FIGURES = (
    BodyShape(30, 1.0),
    BodyShape(5, 0.5),
    BodyShape(40, 0.0, weight=1.0, muscle=0.3),
    BodyShape(80, 1.0, weight=0.2),
)


@pytest.fixture(scope='module')
def body():
    return load_body()


@pytest.fixture(scope='module', params=FIGURES)
def rest(request, body):
    return shape_body(body, request.param)


def pose_of(**degrees):
    angles = np.zeros(len(ANGLES))
    for name, value in {'l_elevation': 12, 'r_elevation': 12, **degrees}.items():
        angles[ANGLE_NUMBERS[name]] = np.radians(value)
    return angles


@pytest.mark.parametrize(
    ('clear', 'degrees'),
    [
        (True, {}),
        (True, {'l_elevation': 90, 'r_plane': 90, 'r_elevation': 90}),
        (True, {'l_elevation': 170, 'r_elevation': 170}),
        (True, {'l_hip_flexion': 90, 'r_hip_flexion': 90, 'l_knee': 90, 'r_knee': 90,
                'l_hip_abduction': 8, 'r_hip_abduction': 8}),
        # A forearm through the belly, shank through shank, a thigh through the chest.
        (False, {'l_elevation': 5, 'l_axial': -70, 'l_elbow': 100}),
        (False, {'l_hip_abduction': -12, 'r_hip_abduction': -12}),
        (False, {'l_hip_flexion': 118, 'bend': 60, 'l_knee': 40, 'lean': 20}),
    ],
)  # fmt: skip
def test_self_collisions_are_detected(body, rest, clear, degrees):
    collision_body = fit_collision_body(body, rest)
    depth = deepest_penetration(collision_body, pose_of(**degrees)[None])[0]
    assert depth <= MAX_PENETRATION if clear else depth > MAX_PENETRATION


def test_hand_inside_the_head_is_detected(body, rest):
    collision_body = fit_collision_body(body, rest)
    rig, angles = collision_body.rig, pose_of()
    at = rig.heads[rig.numbers['head']] - rig.heads[rig.numbers['spine01']]
    angles[ARMS[0]], miss = solve_arm(rig, angles[ARMS[0]], at, 0.5)
    assert miss < REACH_TOLERANCE
    assert deepest_penetration(collision_body, angles[None])[0] > MAX_PENETRATION


def test_capsules_approximate_the_skin(body, rest):
    """The distance of each bone's skin from its capsule's axis is about the radius."""
    rig, capsules = fit_collision_body(body, rest)
    posed = pose_body(body, rest, pose_rotations(rig, pose_of())[0], np.zeros(3))
    strongest = body.skin_bones[:, 0]
    for bone, ends, radius in zip(capsules.bones, capsules.ends, capsules.radii, strict=True):
        skin = posed.vertices[strongest == bone]
        if bone == rig.numbers['root']:  # has no own skin
            continue
        axis = posed.heads[bone] + ends @ posed.orientations[bone].T
        distance = [naive_distance(point, point, *axis) for point in skin[::9]]
        assert 0.5 < np.median(distance) / radius < 2.2


def naive_distance(p, q, a, b):
    """Search the shortest distance of two segments on increasingly fine grids."""
    low, high = np.zeros(2), np.ones(2)
    for _ in range(14):
        s, t = np.meshgrid(*np.linspace(low, high, 11).T, indexing='ij')
        way = p + s[..., None] * (q - p) - a - t[..., None] * (b - a)
        length = np.linalg.norm(way, axis=-1)
        best = np.unravel_index(length.argmin(), length.shape)
        at, width = np.array([s[best], t[best]]), 0.25 * (high - low)
        low, high = np.clip(at - width, 0, 1), np.clip(at + width, 0, 1)
    return length.min()


def test_segment_distance_agrees_with_a_search():
    random = np.random.default_rng(0)
    cases = [random.normal(size=(2, 2, 3)) for _ in range(40)]
    point, along = random.normal(size=3), np.array([1.0, 2.0, 3.0])
    cases += [
        np.array([[point, point], [along, along]]),  # two points
        np.array([[point, point], [point, along]]),  # a point on a segment
        np.array([[point, point + along], [point + 1, point + 1 + along]]),  # in parallel
        np.array([[point, point + along], [point + 3 * along, point + 4 * along]]),  # in line
        np.array([[point, point + along], [point, point + along]]),  # the same
    ]
    for first, second in cases:
        expected = naive_distance(*first, *second)
        assert np.sqrt(segment_distance(first, second)) == pytest.approx(expected, abs=2e-3)
        assert segment_distance(second, first) == pytest.approx(
            segment_distance(first, second), abs=1e-9
        )


def test_mean_distances_of_the_skin_agree_with_the_equation():
    random = np.random.default_rng(1)
    vertices = random.normal(size=(300, 3))
    bones = random.integers(0, 4, size=(300, 8)).astype(np.uint8)
    ends = random.normal(size=(2, 2, 3))
    means = mean_distances(vertices, bones, np.array([-1, 1, -1, 0]), ends)
    for limb, bone in ((1, 1), (0, 3)):
        start, along = ends[limb, 0], ends[limb, 1] - ends[limb, 0]
        own = vertices[bones[:, 0] == bone]
        fraction = np.clip((own - start) @ along / (along @ along), 0, 1)
        expected = np.linalg.norm(own - start - fraction[:, None] * along, axis=1).mean()
        assert means[limb] == pytest.approx(expected, abs=1e-12)
