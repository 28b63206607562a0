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

"""A model made by hand: instant, and good enough to draw and to answer with."""

import numpy as np

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, default_edges, numbers_of
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings

# The height of each kind of joint below the body's middle, in units of rho_bar.
_HEIGHTS = {
    'head': -1.0, 'neck': -0.8, 'torso': -0.3, 'shoulder': -0.7, 'elbow': -0.4, 'wrist': -0.1,
    'hand': 0.0, 'hip': 0.0, 'knee': 0.6, 'ankle': 1.1,
}  # fmt: skip


def tiny_model() -> Model:
    """One tree that is a single leaf: every point votes twice for each joint, once for an edge."""
    joints = numbers_of(DEFAULT_JOINTS)
    edges = default_edges(joints)
    offsets = np.zeros((len(joints), 2, 3), np.float32)
    for row, name in enumerate(DEFAULT_JOINTS):
        side = {'l_': 0.3, 'r_': -0.3}.get(name[:2], 0.0)
        offsets[row, 0] = side, _HEIGHTS[name.removeprefix('l_').removeprefix('r_')], 0.1
        offsets[row, 1] = -side, 0.9, 0.1
    places = offsets[:, 0]
    pair_offsets = places[edges[:, 1]] - places[edges[:, 0]]
    forest = Forest(
        np.array([0], np.int32),
        np.array([-1], np.int16),
        np.array([0], np.uint8),
        np.array([0], np.int32),
        _votes(offsets.reshape(-1, 3), np.repeat(np.arange(len(joints)), 2)),
        _votes(pair_offsets, np.arange(len(edges))),
    )
    lengths = np.maximum(np.linalg.norm(pair_offsets, axis=1), 0.05).astype(np.float32)
    return Model(joints, edges, lengths, Settings(points=120), forest, {'made': 'by hand'})


def _votes(offsets: np.ndarray, targets: np.ndarray) -> LeafVotes:
    return LeafVotes(
        np.array([0, len(targets)], np.int32),
        targets.astype(np.uint8),
        offsets.astype(np.float32),
        np.tile(np.array([0.7, 0.3], np.float32), len(targets))[: len(targets)],
    )
