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

"""Joints that cannot belong to what is visible of a person have no position."""

import math

import numpy as np
from tiny_model import tiny_model

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.reach import LONGEST_REACH, within_reach


def plain_within_reach(joint, points):
    low, high = points.min(axis=0), points.max(axis=0)
    squares = 0.0
    for axis in range(3):
        beyond = max(low[axis] - joint[axis], joint[axis] - high[axis], 0.0)
        if not math.isfinite(joint[axis]):
            return False
        squares += float(beyond) ** 2
    return joint[2] > 0 and math.sqrt(squares) <= LONGEST_REACH


def test_reach_is_the_distance_from_the_visible_points():
    random = np.random.default_rng(2)
    points = random.normal((0, 0, 3), 0.4, (60, 3)).astype(np.float32)
    joints = random.normal((0, 0, 2), 2.5, (500, 3)).astype(np.float32)
    joints[:5, 1] = np.nan, np.inf, -np.inf, np.finfo(np.float32).max, 1e-40
    found = within_reach(joints, points)
    assert found.tolist() == [plain_within_reach(joint, points) for joint in joints]
    assert 0.1 < found.mean() < 0.9


def test_joints_that_votes_lead_astray_have_no_position():
    camera = Intrinsics(140.0, 140.0, 80.0, 60.0)
    depth = np.full((120, 160), 4.0, np.float32)
    labels = np.full(depth.shape, -1, np.int32)
    depth[20:100, 60:100], labels[20:100, 60:100] = 2.0, 1
    model = tiny_model()
    votes = model.forest.joint_votes
    far = model.forest._replace(joint_votes=votes._replace(offset=12 * votes.offset))
    for forest, all_kept in ((model.forest, True), (far, False)):
        estimator = Estimator(model._replace(forest=forest))
        body = estimator.estimate_body(depth, labels, camera, 1)
        assert body is not None
        kept = np.isfinite(body.joints).all(axis=1)
        assert kept.any()
        assert kept.all() == all_kept
        assert (body.confidence[~kept] == 0).all()
        assert within_reach(body.joints, body.silhouette.points).tolist() == kept.tolist()
