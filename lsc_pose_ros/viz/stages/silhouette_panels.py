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

"""Panels of depth, smoothing and silhouette, the first stages of the method (eq. 1, 2)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.viz.drawing.canvas import hide_axes
from lsc_pose_ros.viz.drawing.colours import DIVERGING, EDGE, FAINT, MIDDLE, SEQUENTIAL
from lsc_pose_ros.viz.drawing.crop import look_at
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.shown_body import ShownBody


def draw_metres(axes: Axes, shown: ShownBody) -> None:
    """Draw the body's depth in metres."""
    frame = shown.frame
    hide_axes(axes)
    on_body = (frame.labels == shown.number) & (frame.depth > 0)
    metres = np.where(on_body, frame.depth, np.nan)
    near, far = np.nanpercentile(metres, [1, 99])
    image = axes.imshow(metres, cmap=f'{SEQUENTIAL}_r', vmin=near, vmax=far)
    look_at(axes, shown.box)
    axes.set_title('depth of the body, m')
    _add_colour_bar(axes, image)


def draw_smoothing(axes: Axes, shown: ShownBody) -> None:
    """Draw by how much smoothing changes the depth of each pixel, millimetres (eq. 1)."""
    hide_axes(axes)
    window, smoothed = shown.result.window, shown.result.silhouette.smoothed
    with np.errstate(invalid='ignore'):  # the depth of the background is infinity
        moved = 1000 * (smoothed.depth - window.depth)
    limit = max(float(np.nanpercentile(np.abs(moved), 98)), 1e-3)
    height, width = moved.shape
    left, top = window.column - 0.5, window.row - 0.5
    image = axes.imshow(
        moved,
        cmap=DIVERGING,
        vmin=-limit,
        vmax=limit,
        extent=(left, left + width, top + height, top),
    )
    _draw_outline(axes, shown)
    look_at(axes, shown.box)
    axes.set_title('change by smoothing, mm')
    _add_colour_bar(axes, image)


def draw_silhouette(axes: Axes, shown: ShownBody) -> None:
    """Draw all edge pixels E and the points E' among them that are kept (eq. 2).

    If `Settings.sample` is 'body', E are all pixels of the body.
    """
    silhouette = shown.result.silhouette
    draw_depth(axes, shown.frame, shown.box, body=shown.number)
    edges = np.stack([silhouette.columns, silhouette.rows], axis=1)
    draw_dots(axes, edges, Dot(3, EDGE, marker='s'))
    kept = project(silhouette.points, shown.frame.camera)
    draw_dots(axes, kept, Dot(3.5, MIDDLE, layer=3))
    name = 'points' if shown.settings.sample == 'body' else 'silhouette'
    axes.set_title(f'{name}: {len(silhouette.points)} of {len(silhouette.rows)}')


def _draw_outline(axes: Axes, shown: ShownBody) -> None:
    """Draw the outline of the body's mask."""
    mask = (shown.frame.labels == shown.number).astype(float)
    axes.contour(mask, levels=[0.5], colors=[FAINT], linewidths=0.6)


def _add_colour_bar(axes: Axes, image: AxesImage) -> None:
    """Add the colour bar below the panel."""
    inset = axes.inset_axes((0.2, 0.034, 0.6, 0.016))
    bar = axes.figure.colorbar(image, cax=inset, orientation='horizontal')
    bar.outline.set_visible(False)
    inset.tick_params(length=2, pad=1, labelsize=7)
    inset.xaxis.set_major_locator(MaxNLocator(4))
