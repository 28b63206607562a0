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

"""Figures of one point's descriptor: its bins in the image, and their values (eq. 3, 4)."""

import math
from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.pose.features.point_features import describe_points
from lsc_pose_ros.pose.features.shape_context_3d import (
    AZIMUTH_BINS,
    LEVEL_SCALE,
    RADIUS_BINS,
    ZENITH_BINS,
)
from lsc_pose_ros.viz.drawing.canvas import hide_axes, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER, EDGE, FILLING, MIDDLE, RIGHT
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.shown_body import ShownBody


def shown_point(shown: ShownBody) -> int:
    """Return the index of the silhouette point whose descriptor is drawn: the outermost in x."""
    x = shown.result.silhouette.points[:, 0]
    return int(np.abs(x - x.mean()).argmax())


def bin_radii(reach: float, inner_radius: float) -> NDArray[np.float64]:
    """Return the limits of the radius bins, metres, shape (RADIUS_BINS + 1,).

    Args:
        reach: the reach of the descriptor, metres.
        inner_radius: the inner limit of the first bin, as a fraction of `reach`.
    """
    return reach * inner_radius ** np.linspace(1, 0, RADIUS_BINS + 1)


def draw_feature(axes: Axes, shown: ShownBody) -> None:
    """Draw the bins of one descriptor, or a sentence if the model has another feature."""
    if shown.settings.feature == '3dlsc':
        draw_bins(axes, shown)
        return
    hide_axes(axes)
    sentence = (
        f'The feature of this model, {shown.settings.feature}, is not drawn; '
        'only that of the paper, 3dlsc, is.'
    )
    axes.text(0.5, 0.5, fill(sentence, 24), ha='center', va='center', transform=axes.transAxes)
    axes.set_title('the feature of one point')


def draw_bins(axes: Axes, shown: ShownBody) -> None:
    """Draw the bins of one descriptor, viewed from the camera, and the points within."""
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    camera, points = shown.frame.camera, shown.result.silhouette.points
    reach = shown.result.scale * shown.settings.support_radius
    centre = points[shown_point(shown)]
    inside = np.linalg.norm(points - centre, axis=1) <= reach
    pixels = project(points, camera)
    draw_dots(axes, pixels[~inside], Dot(3, BORDER))
    middle = project(centre, camera)
    radii = bin_radii(reach, shown.settings.inner_radius) * camera.fx / centre[2]
    for radius in radii:
        axes.add_patch(
            Circle((middle[0], middle[1]), radius, fill=False, edgecolor=MIDDLE, linewidth=0.6)
        )
    for azimuth in np.arange(AZIMUTH_BINS) * (2 * math.pi / AZIMUTH_BINS):
        direction = np.array([math.cos(azimuth), math.sin(azimuth)])
        ends = np.stack([middle + radii[0] * direction, middle + radii[-1] * direction])
        axes.plot(*ends.T, color=MIDDLE, linewidth=0.4)
    draw_dots(axes, pixels[inside], Dot(4, EDGE, layer=3))
    draw_dots(axes, middle[None], Dot(28, RIGHT, rim='white', layer=4))
    axes.set_title('the bins of one point')


def descriptor_figure(shown: ShownBody) -> Figure:
    """Return the figure of one descriptor: its bins on the body, and their values."""
    figure = new_figure(7.6, 3.9)
    reach = shown.result.scale * shown.settings.support_radius
    figure.suptitle(f'one descriptor; its reach is {100 * reach:.0f} cm')
    parts = figure.subfigures(1, 2, squeeze=False, width_ratios=(0.8, 1.4))
    left, right = parts[0]
    draw_bins(left.subplots(), shown)
    quantised = describe_points(
        shown.result.silhouette,
        np.array([shown_point(shown)]),
        shown.result.scale,
        shown.frame.camera,
        shown.settings,
    )
    fractions = bin_fractions(quantised[0])
    grid = right.subplots(2, 3, subplot_kw={'projection': 'polar'}).ravel()
    for zenith, axes in enumerate(grid):
        _draw_rose(axes, fractions[:, :, zenith], float(fractions.max()))
        axes.set_title(_zenith_name(zenith), pad=2)
    scale = ScalarMappable(Normalize(0, float(fractions.max())), FILLING)
    bar = right.colorbar(scale, ax=list(grid), shrink=0.7, aspect=30, pad=0.02)
    bar.outline.set_visible(False)
    bar.set_label('fraction of the points within reach')
    return figure


def bin_fractions(quantised: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return the fraction of all weight in each bin of a quantised descriptor (eq. 3).

    It is exact to the steps of the quantisation, which ends at (255 / LEVEL_SCALE)^2, a quarter.

    Args:
        quantised: shape (360,).

    Returns:
        the fractions, shape (RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS).
    """
    fractions = (quantised.astype(np.float32) / np.float32(LEVEL_SCALE)) ** 2
    return fractions.reshape(RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS)


def _draw_rose(axes: PolarAxes, fractions: NDArray[np.float32], highest: float) -> None:
    """Draw the bins of one zenith range, shape (radius, azimuth), viewed from the camera."""
    # y points down in the image, so the azimuth turns clockwise.
    axes.set_theta_direction(-1)
    step = 2 * math.pi / AZIMUTH_BINS
    colours = mpl.colormaps[FILLING](Normalize(0, highest)(fractions))
    for radius in range(RADIUS_BINS):
        axes.bar(
            step * np.arange(AZIMUTH_BINS), 1, step, radius + 0.5, align='edge',
            color=colours[radius], edgecolor=BORDER, linewidth=0.4,
        )  # fmt: skip
    axes.set_ylim(0, RADIUS_BINS + 0.5)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines['polar'].set_visible(False)


def _zenith_name(zenith: int) -> str:
    step = 180 // ZENITH_BINS
    name = f'{zenith * step}\N{EN DASH}{(zenith + 1) * step}°'
    ends = {0: ' behind', ZENITH_BINS - 1: ' in front'}
    return name + ends.get(zenith, '')
