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

"""Skeletons over an image; left, right and middle have their own colours."""

from enum import Enum

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import drawn_edges, names_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.viz.drawing.colours import (
    GROUND_TRUTH,
    LEFT,
    MIDDLE,
    RIGHT,
    bone_colour,
    side_colour,
)
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots

_BONE, _BAND = 2.2, 5.0  # line widths, points


class Look(Enum):
    """The two looks of a skeleton."""

    SIDES = 'sides'  # thin bones in the colours of left, right and middle
    GROUND_TRUTH = 'ground truth'  # a broad band below the estimate


def draw_skeletons(
    axes: Axes, skeletons: Skeletons, camera: Intrinsics, look: Look = Look.SIDES
) -> None:
    """Draw all bodies of `skeletons` over the image of `camera`."""
    for positions in skeletons.positions:
        draw_bones(axes, skeletons.joints, project(positions, camera), look)


def draw_bones(
    axes: Axes,
    joints: NDArray[np.uint16],
    positions: NDArray[np.floating],
    look: Look = Look.SIDES,
) -> None:
    """Draw one skeleton.

    Args:
        axes: the axes.
        joints: the joints' numbers, shape (J,).
        positions: in the units of `axes`, NaN if unknown, shape (J, 2).
        look: the look.
    """
    if look is Look.GROUND_TRUTH:
        _draw_band(axes, joints, positions)
        return
    names = names_of(joints)
    casing = [Stroke(linewidth=_BONE + 1.4, foreground='white'), Normal()]
    for parent, child in drawn_edges(joints):
        axes.plot(
            *positions[[parent, child]].T,
            color=bone_colour(names[parent], names[child]),
            linewidth=_BONE,
            solid_capstyle='round',
            path_effects=casing,
            zorder=6,
        )
    colours = [side_colour(name) for name in names]
    draw_dots(axes, positions, Dot(16, colours, rim='white', layer=7))


def _draw_band(axes: Axes, joints: NDArray[np.uint16], positions: NDArray[np.floating]) -> None:
    for edge in drawn_edges(joints):
        axes.plot(
            *positions[edge].T,
            color=GROUND_TRUTH,
            linewidth=_BAND,
            solid_capstyle='round',
            zorder=4,
        )
    draw_dots(axes, positions, Dot(_BAND**2, GROUND_TRUTH, layer=4))


def legend_lines(*, ground_truth: bool) -> list[Line2D]:
    """Return the legend's entries for skeletons, also for ground truth if it is drawn."""
    sides = ((LEFT, "person's left"), (RIGHT, "person's right"), (MIDDLE, 'middle'))
    lines = [
        Line2D([], [], color=colour, linewidth=_BONE, marker='o', markersize=4, label=label)
        for colour, label in sides
    ]
    if ground_truth:
        lines.append(
            Line2D(
                [],
                [],
                color=GROUND_TRUTH,
                linewidth=_BAND,
                solid_capstyle='butt',
                label='ground truth',
            )
        )
    return lines
