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

"""Noise of sensors that measure disparity: structured light, active and passive stereo.

These sensors see a surface from two viewpoints, one of which can be a projector, and measure the
disparity between them. Disparity is proportional to 1/z, so the error of z grows with z²
(Khoshelham and Elberink, Accuracy and Resolution of Kinect Depth Data, Sensors 12, 2012). The
effects, in this order:

1. Surfaces that the second viewpoint does not see are lost. Because it is to the right of the
   camera, objects cast a shadow on their left. If it is a camera, it does not see the left margin
   of the image. Surfaces at grazing angles, far away or without texture are also lost.
2. Disparity is matched over a window around each pixel. So edges are displaced, and large windows
   enlarge objects in front: edge fattening (Scharstein and Szeliski, A Taxonomy and Evaluation of
   Dense Two-Frame Stereo Correspondence Algorithms, IJCV 47, 2002, section 5).
3. Surfaces at similar distances are averaged over the window.
4. Noise is added to 1/z, correlated between pixels with overlapping windows, and the sum is
   rounded to a step.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.sensors.correlated_noise import correlated_field
from lsc_pose_ros.synthetic.sensors.disparity_filters import (
    fill_holes,
    smooth,
    smoothing_factor,
)
from lsc_pose_ros.synthetic.sensors.optics import DepthRange, nearest_pixel, slope
from lsc_pose_ros.synthetic.sensors.triangulation_sensors import Triangulation

HALF_PIXEL = 0.5
"""Half the width of a pixel, pixels."""

EDGE = 0.05
"""Least difference of 1/z between neighbours at an edge that filters keep, 1/m; our choice."""

RANGE_FADING = 0.25
"""The loss rises from 0 at the end of the range to 1 at this fraction beyond it; our choice."""

LOGISTIC_SCALE = 1.702
"""Scale at which the logistic function approximates the normal distribution within 0.01."""

MAX_PROBABILITY = 0.999
"""Higher probabilities of loss count as 1."""


class InverseDepth(NamedTuple):
    """The inverse depth image on its way through the model.

    Attributes:
        inverse_depth: 1/z, 1/m; 0 in empty pixels, negative in lost ones, shape (H, W).
        labels: the body that a pixel shows, or NO_BODY, shape (H, W).
    """

    inverse_depth: NDArray[np.float32]
    labels: NDArray[np.int32]


def apply_triangulation(
    sensor: Triangulation,
    depth_range: DepthRange,
    image: DepthImage,
    camera: Intrinsics,
    random: np.random.Generator,
) -> DepthImage:
    """Return `image` with the noise of `sensor`; lost pixels have depth 0 and no body.

    Args:
        sensor: the sensor.
        depth_range: its range.
        image: of any size; effects in pixels scale with the focal length.
        camera: the image's intrinsics.
        random: the generator; the sequence of its calls depends only on the image size.
    """
    shape = image.depth.shape
    scale = camera.fx / sensor.focal
    window = sensor.window * scale
    lost_noise = correlated_field(shape, window, random)
    shifts = np.stack([correlated_field(shape, window, random) for _ in range(2)])
    growth = correlated_field(shape, window, random)
    noise = correlated_field(shape, window, random)
    visible = InverseDepth(np.empty(shape, np.float32), image.labels)
    see_surfaces(image.depth, sensor, depth_range, camera, lost_noise, visible.inverse_depth)
    matched = InverseDepth(np.empty(shape, np.float32), np.empty(shape, np.int32))
    fattening = np.float32(sensor.fattening * scale) * (1 + np.float32(0.5) * growth)
    match_windows(
        visible,
        np.float32(sensor.edge_jitter * scale) * shifts,
        fattening,
        sensor.max_difference,
        matched,
    )
    radius = round(sensor.averaging * scale)
    averaged = average_window(matched.inverse_depth, radius, sensor.max_difference)
    apply_filters(sensor, averaged, matched.labels, scale, random)
    noisy = DepthImage(np.empty(shape, np.float32), matched.labels)
    quantise(averaged, noise, sensor, noisy)
    return noisy


def apply_filters(
    sensor: Triangulation,
    inverse_depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    scale: float,
    random: np.random.Generator,
) -> None:
    """Fill holes and smooth 1/z, in place, as the driver of `sensor` does, if it does.

    Half of the images keep large edges.
    """
    if not sensor.smoothing:
        return
    strength, keeps_edges = random.random(2)
    limit = EDGE if keeps_edges < 0.5 else math.inf
    fill_holes(inverse_depth, labels, round(sensor.filling * scale))
    factor = smoothing_factor(sensor.smoothing * scale * (0.2 + 0.8 * float(strength)))
    smooth(inverse_depth, factor, limit)


@exact_kernel
def see_surfaces(
    depth: NDArray[np.float32],
    sensor: Triangulation,
    depth_range: DepthRange,
    camera: Intrinsics,
    lost_noise: NDArray[np.float32],
    inverse_depth: NDArray[np.float32],
) -> None:
    """Write 1/z, negative if the pixel is lost by occlusion, angle, range or dropout.

    The second viewpoint sees a pixel of column u at u - fx baseline / z. If it sees two surfaces
    of a row in another order than the camera, the farther one counts as hidden: the ordering
    constraint, which is exact except for objects that are thinner than their shadow.
    """
    height, width = depth.shape
    move = camera.fx * sensor.baseline
    steep = math.tan(math.radians(sensor.grazing_angle))
    focal = 0.5 * (camera.fx + camera.fy)
    dropout_limit = normal_quantile(sensor.dropout)
    for row in range(height):
        leftmost = math.inf
        for column in range(width - 1, -1, -1):
            inverse_depth[row, column] = 0.0
            z = float(depth[row, column])
            if z <= 0.0:
                continue
            inverse_depth[row, column] = -1.0 / z
            position = column - move / z
            outside = sensor.cameras == 2 and position < -HALF_PIXEL
            hidden = outside or position > leftmost - HALF_PIXEL
            leftmost = min(leftmost, position)
            if hidden or z < depth_range.nearest:
                continue
            loss = max(0.0, (z / depth_range.farthest - 1.0) / RANGE_FADING)
            tilt = slope(depth, row, column, focal)
            if tilt > steep:
                loss += 1.0 - steep / tilt
            below = dropout_limit if loss == 0.0 else normal_quantile(sensor.dropout + loss)
            if lost_noise[row, column] >= below:
                inverse_depth[row, column] = 1.0 / z


@exact_kernel
def normal_quantile(probability: float) -> float:
    """Return the approximate quantile of the normal distribution; infinite near 0 and 1."""
    if probability <= 0.0:
        return -math.inf
    if probability >= MAX_PROBABILITY:
        return math.inf
    return math.log(probability / (1.0 - probability)) / LOGISTIC_SCALE


@exact_kernel
def match_windows(
    visible: InverseDepth,
    shifts: NDArray[np.float32],
    fattening: NDArray[np.float32],
    max_difference: float,
    matched: InverseDepth,
) -> None:
    """Displace and grow edges: each pixel shows a displaced pixel, or a nearer one beside that.

    Args:
        visible: the inverse depth that the sensor sees or loses.
        shifts: row and column offsets of the sampled position of each pixel, shape (2, H, W).
        fattening: growth of edges at each pixel, pixels, shape (H, W).
        max_difference: minimum difference of 1/z of a surface that grows, 1/m.
        matched: is filled; lost pixels are empty.
    """
    inverse_depth, labels = visible
    matched_near, matched_labels = matched
    height, width = inverse_depth.shape
    for row in range(height):
        for column in range(width):
            at_row = nearest_pixel(row + shifts[0, row, column], height)
            at_column = nearest_pixel(column + shifts[1, row, column], width)
            best = inverse_depth[at_row, at_column]
            label = labels[at_row, at_column]
            radius = int(np.floor(fattening[row, column] + 0.5))
            if radius > 0:
                least = abs(best) + max_difference
                for down, right in ((-radius, 0), (radius, 0), (0, -radius), (0, radius)):
                    to_row = min(max(at_row + down, 0), height - 1)
                    to_column = min(max(at_column + right, 0), width - 1)
                    if inverse_depth[to_row, to_column] > max(best, least):
                        best = inverse_depth[to_row, to_column]
                        label = labels[to_row, to_column]
            matched_near[row, column] = max(best, 0.0)
            matched_labels[row, column] = label


def average_window(
    inverse_depth: NDArray[np.float32], radius: int, max_difference: float
) -> NDArray[np.float32]:
    """Average 1/z over a square, along rows and then along columns.

    Args:
        inverse_depth: 1/z, 0 in empty pixels, shape (H, W).
        radius: half the square's width, pixels.
        max_difference: pixels whose 1/z differs more from the middle's are left out.

    Returns:
        The averages, shape (H, W); empty pixels stay empty.
    """
    if radius < 1:
        return inverse_depth
    for down, right in ((0, 1), (1, 0)):
        averaged = np.empty_like(inverse_depth)
        average_along(inverse_depth, radius, max_difference, (down, right), averaged)
        inverse_depth = averaged
    return inverse_depth


@exact_kernel
def average_along(
    inverse_depth: NDArray[np.float32],
    radius: int,
    max_difference: float,
    direction: tuple[int, int],
    averaged: NDArray[np.float32],
) -> None:
    """Fill `averaged` with the average along a direction, given as rows and columns per step."""
    height, width = inverse_depth.shape
    down, right = direction
    for row in range(height):
        for column in range(width):
            middle = inverse_depth[row, column]
            averaged[row, column] = middle
            if middle <= 0.0:
                continue
            position = row * down + column * right
            last = (height - 1) * down + (width - 1) * right
            total, count = 0.0, 0
            for step in range(-min(radius, position), min(radius, last - position) + 1):
                other = inverse_depth[row + step * down, column + step * right]
                if other > 0.0 and abs(other - middle) <= max_difference:
                    total += other
                    count += 1
            averaged[row, column] = total / count


@exact_kernel
def quantise(
    inverse_depth: NDArray[np.float32],
    noise: NDArray[np.float32],
    sensor: Triangulation,
    noisy: DepthImage,
) -> None:
    """Add noise to 1/z and round it; remove the labels of pixels without depth."""
    depth, labels = noisy
    height, width = inverse_depth.shape
    for row in range(height):
        for column in range(width):
            whole = 0.0
            if inverse_depth[row, column] > 0.0:
                steps = (
                    inverse_depth[row, column] + sensor.deviation * noise[row, column]
                ) / sensor.step
                whole = np.floor(steps + 0.5)
            if whole >= 1.0:
                depth[row, column] = 1.0 / (whole * sensor.step)
            else:
                depth[row, column] = 0.0
                labels[row, column] = NO_BODY
