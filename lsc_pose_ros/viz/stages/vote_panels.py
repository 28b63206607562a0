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

"""Panels of the votes of the silhouette points for joints and for pairs of joints (eq. 13)."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.colours import MIDDLE, bone_colour, side_colour
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.shown_body import ShownBody


def draw_joint_votes(axes: Axes, shown: ShownBody, model: Model) -> None:
    """Draw the heaviest votes for each joint; the smaller a weight, the fainter its vote."""
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    votes = shown.result.joint_votes
    for joint, name in enumerate(names_of(model.joints)):
        positions, weights = positions_and_weights(votes, joint)
        _scatter(axes, project(positions, shown.frame.camera), weights, side_colour(name))
    axes.set_title('votes for the joints')


def draw_pair_votes(axes: Axes, shown: ShownBody, model: Model) -> None:
    """Draw the heaviest votes for each child joint, relative to its estimated parent."""
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    names = names_of(model.joints)
    joints, votes = shown.result.joints, shown.result.pair_votes
    for edge, (parent, child) in enumerate(model.edges):
        offsets, weights = positions_and_weights(votes, edge)
        colour = bone_colour(names[parent], names[child])
        _scatter(axes, project(joints[parent] + offsets, shown.frame.camera), weights, colour)
    for parent, child in model.edges:
        bone = project(joints[[parent, child]], shown.frame.camera)
        axes.plot(*bone.T, color=MIDDLE, linewidth=0.7)
    parents = project(joints[np.unique(model.edges[:, 0])], shown.frame.camera)
    draw_dots(axes, parents, Dot(10, MIDDLE, rim='white', layer=4))
    axes.set_title('votes for the pairs')


def positions_and_weights(
    votes: Votes, target: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the positions, (M, 3), and weights, (M,), of the votes for one joint or edge."""
    of_target = slice(votes.start[target], votes.start[target + 1])
    return votes.position[of_target], votes.weight[of_target]


def _scatter(
    axes: Axes, pixels: NDArray[np.float32], weights: NDArray[np.float32], colour: str
) -> None:
    if len(weights) == 0:
        return
    strength = 0.08 + 0.42 * weights / weights.max()
    draw_dots(axes, pixels, Dot(6, colour, layer=3), strength)
