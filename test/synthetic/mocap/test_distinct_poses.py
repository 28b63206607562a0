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

"""Tests the selection of distinct poses."""

import numpy as np
import pytest

from lsc_pose_ros.synthetic.mocap.distinct_poses import (
    distinct_poses,
    pose_distance,
    reference_joints,
)
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS


def test_distinct_poses_cover_all_poses():
    random = np.random.default_rng(11)
    walk = np.cumsum(random.normal(0, 0.01, (200, 4, 3)), axis=0)
    frames = np.arange(20, 200)
    kept = distinct_poses(walk, frames, 0.05)
    difference = np.linalg.norm(walk[:, None] - walk[kept][None], axis=-1).max(axis=-1)
    among = difference[kept] + np.eye(len(kept))
    assert set(kept) <= set(frames)
    assert among.min() >= 0.05 - 1e-6
    assert difference[frames].min(axis=1).max() < 0.05


def test_reference_joints_of_the_standing_pose():
    joints = reference_joints(np.broadcast_to(np.eye(3), (1, len(SEGMENTS), 3, 3)))[0]
    assert joints[:, 1].max() == pytest.approx(0.71)  # head above and soles below the hips
    assert joints[:, 1].min() == pytest.approx(-0.895)
    left, right = joints[2:8], joints[8:]
    np.testing.assert_allclose(left, right * [-1, 1, 1])
    others = joints + np.array([[[0, 0, 0.3]], [[0.2, 0, 0]]])
    assert pose_distance(joints, others) == pytest.approx(0.2)
