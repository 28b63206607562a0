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

"""Figures of the graph's results: unary modes, best combination, after ascent (eq. 16, 17)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import back_project, project
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.canvas import hide_axes, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.drawing.legend import LEGEND_HEIGHT, add_legend_entries
from lsc_pose_ros.viz.drawing.skeleton_overlay import Look, draw_bones, legend_lines
from lsc_pose_ros.viz.stages.shown_body import ShownBody

_MOST_DOTS = 4000


def draw_joints(axes: Axes, shown: ShownBody, model: Model) -> None:
    """Draw the estimated skeleton over the image, and the ground truth below it."""
    _draw_front(axes, shown, model, shown.result.joints)
    axes.set_title('joints' + _error(shown, model, shown.result.joints))


def skeleton_figure(shown: ShownBody, model: Model) -> Figure:
    """Return a figure of the skeleton after each step, from the front and from the side."""
    result = shown.result
    steps = {
        'each joint by itself': result.unary,
        'best combination': result.chosen,
        'after ascent': result.joints,
    }
    figure = new_figure(7.6, 6.6 + LEGEND_HEIGHT)
    grid = figure.subplots(2, len(steps))
    for column, (name, joints) in enumerate(steps.items()):
        _draw_front(grid[0, column], shown, model, joints)
        _draw_side(grid[1, column], shown, model, joints)
        grid[0, column].set_title(name + _error(shown, model, joints))
    known = np.isfinite(shown.ground_truth(model.joints)).any()
    add_legend_entries(figure, legend_lines(ground_truth=bool(known)))
    return figure


def _draw_front(axes: Axes, shown: ShownBody, model: Model, joints: NDArray[np.float32]) -> None:
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    numbers, camera = model.joints, shown.frame.camera
    draw_bones(axes, numbers, project(shown.ground_truth(numbers), camera), Look.GROUND_TRUTH)
    draw_bones(axes, numbers, project(joints, camera))


def _draw_side(axes: Axes, shown: ShownBody, model: Model, joints: NDArray[np.float32]) -> None:
    """Draw y over z in metres; nearer is to the left."""
    hide_axes(axes)
    frame, numbers = shown.frame, model.joints
    rows, columns = np.nonzero((frame.labels == shown.number) & (frame.depth > 0))
    step = max(1, len(rows) // _MOST_DOTS)
    rows, columns = rows[::step], columns[::step]
    surface = back_project(columns, rows, frame.depth[rows, columns], frame.camera)
    draw_dots(axes, surface[:, [2, 1]], Dot(1.5, BORDER))
    draw_bones(axes, numbers, shown.ground_truth(numbers)[:, [2, 1]], Look.GROUND_TRUTH)
    draw_bones(axes, numbers, joints[:, [2, 1]])
    axes.set_aspect('equal')
    axes.invert_yaxis()
    axes.set_title('from the side (camera at left)', pad=2)


def _error(shown: ShownBody, model: Model, joints: NDArray[np.float32]) -> str:
    """Return the mean error as part of a title, '' without ground truth."""
    distance = np.linalg.norm(joints - shown.ground_truth(model.joints), axis=-1)
    known = distance[np.isfinite(distance)]
    return f': {100 * known.mean():.1f} cm' if len(known) else ''
