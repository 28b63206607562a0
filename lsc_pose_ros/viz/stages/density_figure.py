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

"""Figures of the joints' densities over the image, and of their modes (eq. 14)."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.canvas import hide_axes, new_figure
from lsc_pose_ros.viz.drawing.colours import LEFT, MIDDLE, RIGHT, side_colour
from lsc_pose_ros.viz.drawing.crop import Box
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.drawing.legend import LEGEND_HEIGHT, add_legend_entries
from lsc_pose_ros.viz.stages.shown_body import ShownBody
from lsc_pose_ros.viz.stages.vote_panels import positions_and_weights

_GRID = 120  # grid points along the longer side of the box
_COLUMNS = 6
_LOWER = 'X'  # the marker of modes that are not the highest


def draw_densities(axes: Axes, shown: ShownBody, model: Model) -> None:
    """Draw the densities of all joints in one panel, each scaled to its own peak."""
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    names = names_of(model.joints)
    for colour in (MIDDLE, LEFT, RIGHT):
        mine = [joint for joint, name in enumerate(names) if side_colour(name) == colour]
        if mine:
            images = [_density_image(shown, joint) for joint in mine]
            _overlay(axes, np.max(images, axis=0), shown.box, colour)
    best = project(shown.result.unary, shown.frame.camera)
    draw_dots(axes, best, Dot(7, 'white', rim=MIDDLE, layer=4))
    axes.set_title('densities of the joints')


def densities_figure(shown: ShownBody, model: Model) -> Figure:
    """Return a figure with a panel for each joint: its density, its highest mode, other modes."""
    names = names_of(model.joints)
    columns = min(_COLUMNS, len(names))
    rows = math.ceil(len(names) / columns)
    figure = new_figure(1.3 * columns, 1.95 * rows + LEGEND_HEIGHT)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for joint, (axes, name) in enumerate(zip(grid, names, strict=False)):
        draw_depth(axes, shown.frame, shown.box, body=shown.number)
        colour = side_colour(name)
        _overlay(axes, _density_image(shown, joint), shown.box, colour)
        _draw_modes(axes, shown, joint)
        axes.set_title(name, pad=2, color=colour)
    for axes in grid[len(names) :]:
        hide_axes(axes)
    add_legend_entries(figure, [_mode('highest mode', 'o'), _mode('lower mode', _LOWER)])
    return figure


def line_integral(
    positions: NDArray[np.float32],
    weights: NDArray[np.float32],
    pixels: NDArray[np.float64],
    camera: Intrinsics,
    bandwidth: float,
) -> NDArray[np.float64]:
    """Return the integral of the density (eq. 14) along each pixel's line of sight, shape (...,).

    A Gaussian's integral along a line is sqrt(pi) h exp(-d^2 / h^2), d the distance of its centre
    from the line.

    Args:
        positions: the votes, metres, shape (M, 3).
        weights: their weights, shape (M,).
        pixels: (column, row), shape (..., 2).
        camera: the intrinsics.
        bandwidth: h, metres.
    """
    x = (pixels[..., 0] - camera.cx) / camera.fx
    y = (pixels[..., 1] - camera.cy) / camera.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    total = np.zeros(x.shape)
    for position, weight in zip(positions.astype(np.float64), weights, strict=True):
        squared = position @ position - (rays @ position) ** 2
        total += weight * np.exp(-squared / bandwidth**2)
    return math.sqrt(math.pi) * bandwidth * total


def _density_image(shown: ShownBody, joint: int) -> NDArray[np.float64]:
    """Return a joint's density over the box, its peak scaled to 1, shape (rows, columns)."""
    box = shown.box
    step = max(box.right - box.left, box.bottom - box.top) / _GRID
    columns = np.arange(box.left + step / 2, box.right, step)
    rows = np.arange(box.top + step / 2, box.bottom, step)
    pixels = np.stack(np.meshgrid(columns, rows), axis=-1)
    positions, weights = positions_and_weights(shown.result.joint_votes, joint)
    bandwidth = shown.settings.joint_bandwidth
    image = line_integral(positions, weights, pixels, shown.frame.camera, bandwidth)
    peak = image.max()
    return image / peak if peak > 0 else image


def _overlay(axes: Axes, image: NDArray[np.float64], box: Box, colour: str) -> None:
    """Draw `image`, 0 to 1, over the depth image: the denser, the more opaque is `colour`."""
    axes.imshow(
        image,
        cmap=LinearSegmentedColormap.from_list('', [to_rgba(colour, 0), to_rgba(colour, 0.95)]),
        vmin=0,
        vmax=1,
        extent=(box.left, box.right, box.bottom, box.top),
        interpolation='bilinear',
        zorder=3,
    )


def _draw_modes(axes: Axes, shown: ShownBody, joint: int) -> None:
    candidates = shown.result.candidates
    modes = candidates.positions[joint, : candidates.counts[joint]]
    pixels = project(modes, shown.frame.camera)
    highest = Dot(20, 'white', rim=MIDDLE, layer=5)
    draw_dots(axes, pixels[1:], highest._replace(marker=_LOWER))
    draw_dots(axes, pixels[:1], highest)


def _mode(label: str, marker: str) -> Line2D:
    return Line2D(
        [], [], linestyle='', marker=marker, markersize=5, markerfacecolor='white',
        markeredgecolor=MIDDLE, markeredgewidth=0.7, label=label,
    )  # fmt: skip
