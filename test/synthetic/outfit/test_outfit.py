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

"""Tests what people wear and carry: it follows the body and counts as the wearer's."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.skin_parts import NO_PART
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_scenes
from lsc_pose_ros.synthetic.outfit.carried import NOTHING, CarriedSize, carried_load
from lsc_pose_ros.synthetic.outfit.garments import sample_garments
from lsc_pose_ros.synthetic.outfit.outfit import outfit_of
from lsc_pose_ros.synthetic.people import PersonSampler, attire_meshes
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.placement import ScenePlacement

FURNISHED = SyntheticSettings(furniture=True, yaw=180.0)
DOWN = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope='module')
def sampler() -> PersonSampler:
    return PersonSampler(FURNISHED)


def test_garments_are_close_to_the_body_in_each_pose(sampler: PersonSampler) -> None:
    random = np.random.default_rng(2)
    placement = ScenePlacement(np.eye(3), np.array([[0.0, 1.2, 3.0]]), 1.2)
    some = 0
    for _ in range(12):
        rest = sampler.sample_body(random)
        person = sampler.sample_person(rest, 3, random)
        person = person._replace(attire=sampler.sample_attire(rest, random))
        for frame in range(3):
            posed = sampler.pose_in_camera(person, frame, placement, 0)
            for mesh, parts in attire_meshes(person, frame, posed, DOWN):
                assert len(parts) == len(mesh.triangles)
                if not len(parts):
                    continue
                some += 1
                assert ((parts >= 1) & (parts <= len(JOINT_NAMES))).all()
                nearest = np.linalg.norm(mesh.vertices[:, None] - posed.joints, axis=2).min(axis=1)
                assert nearest.max() < 0.7
    assert some > 10


def test_weights_of_the_bones_add_up_to_one(sampler: PersonSampler) -> None:
    random = np.random.default_rng(3)
    rest = sampler.sample_body(random)
    counts = []
    for _ in range(60):
        garments = sample_garments(sampler.body, rest, RandomStream(random))
        outfit = outfit_of(sampler.body, rest, garments)
        counts.append(len(garments))
        np.testing.assert_allclose(outfit.weights.sum(axis=1, dtype=int), 65535, atol=2)
        assert (np.diff(outfit.weights.astype(int), axis=1) <= 0).all()
        assert len(outfit.parts) == len(outfit.triangles)
        if len(outfit.triangles):
            assert outfit.triangles.max() < len(outfit.vertices)
    assert 0.3 < np.mean(np.array(counts) == 0) < 0.7


def joints_of(left: tuple[float, float, float], right: tuple[float, float, float]) -> np.ndarray:
    """Return joints of a person who faces the camera, 3 m away, with given hands."""
    joints = np.tile([0.0, 0.0, 3.0], (len(JOINT_NAMES), 1))
    joints[JOINT_NUMBERS['l_hip']] += [0.1, 0.2, 0.0]
    joints[JOINT_NUMBERS['r_hip']] += [-0.1, 0.2, 0.0]
    joints[JOINT_NUMBERS['l_elbow']] += [0.3, 0.0, 0.0]
    joints[JOINT_NUMBERS['r_elbow']] += [-0.3, 0.0, 0.0]
    joints[JOINT_NUMBERS['l_hand']] += left
    joints[JOINT_NUMBERS['r_hand']] += right
    return joints


def test_load_is_between_hands_before_the_trunk() -> None:
    size = CarriedSize(load=(0.3, 0.2), hanging=None, hand='l')
    load = carried_load(size, joints_of((0.2, 0.1, -0.35), (-0.2, 0.1, -0.35)), DOWN)
    np.testing.assert_allclose(load.mesh.vertices.mean(axis=0), [0.0, 0.1, 2.65], atol=0.02)
    low, high = load.mesh.vertices.min(axis=0), load.mesh.vertices.max(axis=0)
    np.testing.assert_allclose(high - low, [0.32, 0.3, 0.2], atol=1e-9)
    assert high[2] <= 3.0 - 0.12 + 1e-9
    left = load.mesh.vertices[load.mesh.triangles][load.parts == 1 + JOINT_NUMBERS['l_hand']]
    assert (left[..., 0] > -1e-9).all()


@pytest.mark.parametrize(
    'hands',
    [
        ((0.6, 0.1, -0.3), (-0.6, 0.1, -0.3)),  # too far apart
        ((0.2, 0.1, 0.0), (-0.2, 0.1, 0.0)),  # beside the trunk
        ((0.2, 0.4, -0.3), (-0.2, 0.0, -0.3)),  # not level
        ((-0.2, 0.1, -0.3), (0.2, 0.1, -0.3)),  # crossed
    ],
)
def test_other_hands_carry_no_load(
    hands: tuple[tuple[float, float, float], tuple[float, float, float]],
) -> None:
    size = CarriedSize(load=(0.3, 0.2), hanging=None, hand='l')
    assert carried_load(size, joints_of(*hands), DOWN) is NOTHING


def test_bag_hangs_below_a_low_hand() -> None:
    size = CarriedSize(load=None, hanging=(0.15, 0.2, 0.05), hand='r')
    load = carried_load(size, joints_of((0.3, 0.3, 0.0), (-0.3, 0.3, 0.0)), DOWN)
    assert set(load.parts.tolist()) == {1 + JOINT_NUMBERS['r_hand']}
    low, high = load.mesh.vertices.min(axis=0), load.mesh.vertices.max(axis=0)
    np.testing.assert_allclose(0.5 * (low + high), [-0.3, 0.58, 3.0], atol=1e-9)
    np.testing.assert_allclose(high - low, [0.1, 0.4, 0.3], atol=1e-9)
    raised = carried_load(size, joints_of((0.3, 0.3, 0.0), (-0.3, -0.3, 0.0)), DOWN)
    assert raised is NOTHING


def test_clothes_have_the_label_of_the_wearer() -> None:
    settings = FURNISHED._replace(frames=12, clip_length=3, noise='none', people=2)
    for scene in synthetic_scenes(settings):
        assert set(np.unique(scene.frame.labels)) <= {NO_BODY, 1, 2}
        np.testing.assert_array_equal(scene.parts != NO_PART, scene.frame.labels != NO_BODY)
