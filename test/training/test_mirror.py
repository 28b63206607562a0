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

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.joints import JOINT_NAMES, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.training.mirror import mirrored, with_mirrored
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.training.train import train


@pytest.fixture
def frame(simple_frames):
    """A frame with two bodies whose principal point is off centre, all joints labelled."""
    rng = np.random.default_rng(0)
    positions = rng.uniform((-0.5, -0.5, 2.0), (0.5, 0.5, 3.0), (2, 20, 3)).astype(np.float32)
    positions[1, 7] = np.nan
    ground_truth = Skeletons(
        np.array([1, 2], np.uint16),
        np.arange(20, dtype=np.uint16),
        positions,
        rng.random((2, 20)).astype(np.float32),
    )
    camera = simple_frames[3].camera._replace(cx=20.25)
    return simple_frames[3]._replace(camera=camera, ground_truth=ground_truth)


def place(frame, name):
    return select_joints(frame.ground_truth, numbers_of([name]))[:, 0]


def test_mirror_exchanges_left_and_right(frame):
    mirror = mirrored(frame)
    np.testing.assert_array_equal(mirror.ground_truth.joints, frame.ground_truth.joints)
    for name in JOINT_NAMES:
        other = {'l_': 'r_', 'r_': 'l_'}.get(name[:2], name[:2]) + name[2:]
        np.testing.assert_array_equal(place(mirror, other), place(frame, name) * [-1, 1, 1])
    left, right = (list(JOINT_NAMES).index(name) for name in ('l_hand', 'r_hand'))
    np.testing.assert_array_equal(
        mirror.ground_truth.confidence[:, right], frame.ground_truth.confidence[:, left]
    )


def test_joint_lies_on_the_same_pixel_of_the_body_in_the_mirror(frame):
    mirror = mirrored(frame)
    pixels = project(place(frame, 'l_knee'), frame.camera)
    reflected = project(place(mirror, 'r_knee'), mirror.camera)
    width = frame.depth.shape[1]
    np.testing.assert_allclose(reflected[:, 0], width - 1 - pixels[:, 0], rtol=1e-5)
    np.testing.assert_allclose(reflected[:, 1], pixels[:, 1], rtol=1e-5)
    np.testing.assert_array_equal(mirror.depth[5], frame.depth[5, ::-1])
    np.testing.assert_array_equal(mirror.labels[20], frame.labels[20, ::-1])


def test_mirror_of_the_mirror_is_the_frame(frame):
    again = mirrored(mirrored(frame))
    np.testing.assert_array_equal(again.depth, frame.depth)
    np.testing.assert_array_equal(again.labels, frame.labels)
    assert again.camera == frame.camera
    for one, two in zip(again.ground_truth, frame.ground_truth, strict=True):
        np.testing.assert_array_equal(one, two)
    assert mirrored(frame._replace(ground_truth=None)).ground_truth is None


def test_skeleton_with_joints_of_one_side_stays_sorted(frame):
    keep = numbers_of(['neck', 'l_elbow', 'l_knee', 'r_hip'])
    ground_truth = Skeletons(
        frame.ground_truth.bodies,
        keep,
        frame.ground_truth.positions[:, keep],
        frame.ground_truth.confidence[:, keep],
    )
    mirror = mirrored(frame._replace(ground_truth=ground_truth)).ground_truth
    assert mirror.joints.tolist() == numbers_of(['neck', 'r_elbow', 'r_knee', 'l_hip']).tolist()
    assert (np.diff(mirror.joints.astype(int)) > 0).all()


def test_training_with_the_mirror_sees_everybody_twice(people, training):
    frames = people[:12]
    assert len(list(with_mirrored(frames))) == 24
    model = train(frames, training._replace(mirror=True, trees=1), {})
    assert model.provenance['people'] == '24'
    assert not np.isnan(model.limb_lengths).any()
