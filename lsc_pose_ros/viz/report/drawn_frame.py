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

"""A panel of one frame: depth, silhouette points, estimate, ground truth, error."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.evaluation.distance_text import distance_text
from lsc_pose_ros.evaluation.evaluate import joint_errors
from lsc_pose_ros.pose.estimator import bodies_in
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.body_window import body_window
from lsc_pose_ros.pose.silhouette.silhouette import find_silhouette
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import EDGE
from lsc_pose_ros.viz.drawing.crop import box_around
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import RING, Dot, draw_dots
from lsc_pose_ros.viz.drawing.legend import frame_legend, ring_entry
from lsc_pose_ros.viz.drawing.skeleton_overlay import Look, draw_skeletons
from lsc_pose_ros.viz.report.page_parts import Picture

_PANEL = (2.2, 2.75)  # inches; its box is 0.8 times as wide as high


class DrawnFrame(NamedTuple):
    """A frame to draw.

    Attributes:
        label: its name, for example 'frame 12'.
        frame: the images, the camera and the ground truth if there is one.
        estimate: the estimated skeletons; None to draw none.
        settings: the parameters of the silhouette.
        marked: joints that get a ring, metres, shape (n, 3); None for none.
        compared: what follows the distance between ground truth and estimate in the caption; ''
            if the label says it.
    """

    label: str
    frame: Frame
    estimate: Skeletons | None = None
    settings: Settings = Settings()
    marked: NDArray[np.float32] | None = None
    compared: str = ''


def has_joints(drawn: DrawnFrame) -> bool:
    """Return whether a skeleton is drawn: an estimate or the ground truth of a known joint."""
    shown = (drawn.estimate, drawn.frame.ground_truth)
    return any(each is not None and known_bodies(each) > 0 for each in shown)


def draw_frame(axes: Axes, drawn: DrawnFrame) -> None:
    """Draw depth, silhouette points and skeletons."""
    frame = drawn.frame
    draw_depth(axes, frame, box_around(frame))
    points = silhouette_pixels(frame, drawn.settings)
    draw_dots(axes, points, Dot(1.6, EDGE, layer=3))
    if drawn.estimate is not None:
        if frame.ground_truth is not None:
            ground_truth = only_joints(frame.ground_truth, drawn.estimate.joints)
            draw_skeletons(axes, ground_truth, frame.camera, Look.GROUND_TRUTH)
        draw_skeletons(axes, drawn.estimate, frame.camera)
    elif frame.ground_truth is not None:
        draw_skeletons(axes, frame.ground_truth, frame.camera)
    if drawn.marked is not None and len(drawn.marked):
        draw_dots(axes, project(drawn.marked, frame.camera), RING)


@house_style()
def frame_panel(drawn: DrawnFrame) -> Figure:
    """Return a figure of one frame, without words."""
    figure = new_figure(*_PANEL)
    axes = figure.subplots()
    draw_frame(axes, drawn)
    return figure


def frame_picture(drawn: DrawnFrame) -> Picture:
    """Return the picture of one frame for a page."""
    return Picture(frame_panel(drawn), description(drawn), caption(drawn))


def frame_entries(drawn: Sequence[DrawnFrame]) -> list[Line2D]:
    """Return the legend of the frames."""
    entries = frame_legend(
        skeletons=any(each.estimate or each.frame.ground_truth for each in drawn),
        ground_truth=any(each.estimate and each.frame.ground_truth for each in drawn),
    )
    if any(each.marked is not None and len(each.marked) for each in drawn):
        entries.append(ring_entry('joint with a problem'))
    return entries


def description(drawn: DrawnFrame) -> str:
    """Return what a reader sees in the panel: people, skeletons and the largest error."""
    frame, estimate = drawn.frame, drawn.estimate
    people = len(bodies_in(frame.labels))
    words = [f'{people} {"person" if people == 1 else "people"} in grey depth']
    if estimate is not None:
        words.append('the estimated skeleton')
        if frame.ground_truth is not None:
            words.append('the ground truth as a band below it')
    elif frame.ground_truth is not None:
        words.append('the ground truth as a skeleton')
    return f'{caption(drawn)}. {", ".join(words)}{_largest_error(drawn)}.'


def _largest_error(drawn: DrawnFrame) -> str:
    ground_truth, estimate = drawn.frame.ground_truth, drawn.estimate
    if ground_truth is None or estimate is None or len(ground_truth.bodies) == 0:
        return ''
    errors = joint_errors(estimate, ground_truth)
    finite = np.where(np.isfinite(errors), errors, -1)
    if finite.size == 0 or finite.max() < 0:
        return ''
    joint = int(np.unravel_index(finite.argmax(), finite.shape)[1])
    name = names_of(estimate.joints)[joint]
    return f'; farthest off is {name}, by {distance_text(float(finite.max()))}'


def only_joints(ground_truth: Skeletons, joints: NDArray[np.uint16]) -> Skeletons:
    """Return `joints` of `ground_truth`, NaN for those that it does not have."""
    positions = select_joints(ground_truth, joints)
    return Skeletons(
        ground_truth.bodies, joints, positions, np.ones(positions.shape[:2], np.float32)
    )


def silhouette_pixels(frame: Frame, settings: Settings) -> NDArray[np.float32]:
    """Return the pixels (column, row) of all bodies' silhouette points E', shape (n, 2)."""
    pixels = [np.zeros((0, 2), np.float32)]
    for body in bodies_in(frame.labels):
        window = body_window(frame.depth, frame.labels, frame.camera, int(body), settings)
        if window is not None:
            rays = image_rays(frame.camera, *frame.depth.shape)
            silhouette = find_silhouette(window, rays, settings)
            pixels.append(project(silhouette.points, frame.camera))
    return np.concatenate(pixels)


def caption(drawn: DrawnFrame) -> str:
    """Return the frame's label and, with ground truth, the mean error of its joints."""
    ground_truth, estimate = drawn.frame.ground_truth, drawn.estimate
    if ground_truth is None or estimate is None or len(ground_truth.bodies) == 0:
        return drawn.label
    errors = joint_errors(estimate, ground_truth)
    labelled = errors[~np.isnan(errors)]
    estimated = labelled[np.isfinite(labelled)]
    if len(labelled) == 0:
        return drawn.label
    if len(estimated) == 0:
        return f'{drawn.label}: no estimate'
    missing = len(labelled) - len(estimated)
    without = f', {missing} missing' if missing else ''
    distance = distance_text(float(estimated.mean()))
    if drawn.compared:
        return f'{drawn.label}; {distance} {drawn.compared}{without}'
    return f'{drawn.label}: {distance}{without}'
