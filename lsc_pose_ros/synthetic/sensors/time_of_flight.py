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

"""Noise of time-of-flight sensors.

The effects, in this order:

1. A pixel integrates light over an area. At an edge it receives light from two surfaces and
   measures a distance in between: flying pixels (Foix, Alenyà, Torras, Lock-in Time-of-Flight
   (ToF) Cameras: A Survey, IEEE Sensors Journal 11, 2011). The nearer surface returns more light,
   as 1/z². Some sensors detect and drop a part of these pixels.
2. Surfaces that return too little light, because they are far away or tilted, are lost.
3. Each pixel has independent noise, which is stronger on far and on tilted surfaces.
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
from lsc_pose_ros.synthetic.sensors.optics import DepthRange, focal_length, nearest_pixel, slope

WALL_DISTANCE = (1.0, 3.0)
"""Distance of the wall that is assumed behind a body without background, metres; our choice."""

EDGE_JITTER = 0.35
"""Deviation of the position of edges within a pixel, pixels of the image; our choice."""

JITTER_SPACING = 3.0
"""Correlation length of that deviation, pixels of the image; our choice."""

MIXED_PIXEL_DEPTH = 0.05
"""Depth difference within one pixel's area that makes a flying pixel, metres; our choice."""

MAX_ANGLE = math.radians(80.0)
"""Limit of the angle in the noise formula, which is infinite at 90 degrees; our choice."""


class TimeOfFlight(NamedTuple):
    """A time-of-flight sensor; pixels are those of its own full image.

    The deviation of the noise, metres, at distance z, metres, and angle θ is
    constant + linear z + square z² + tilted z^1.5 (θ / (π/2 - θ))².

    Attributes:
        focal: focal length, pixels.
        area: width of the area over which a pixel integrates, pixels.
        constant: see above.
        linear: see above.
        square: see above.
        tilted: see above.
        filtered_fraction: fraction of flying pixels that the sensor drops.
    """

    focal: float
    area: float
    constant: float
    linear: float
    square: float
    tilted: float
    filtered_fraction: float


KINECT_V2 = TimeOfFlight(
    focal=focal_length(512, 70.6),
    area=1.0,  # our choice
    # Fankhauser, Bloesch, Rodriguez, Kaestner, Hutter, Siegwart, Kinect v2 for Mobile Robot
    # Navigation: Evaluation and Modeling, ICAR 2015.
    constant=0.0015,
    linear=-0.0005,
    square=0.0003,
    tilted=0.0001,
    filtered_fraction=0.5,  # our choice
)

AZURE = TimeOfFlight(
    focal=focal_length(640, 75.0),
    area=1.0,  # our choice
    # Our choice: well within the 17 mm up to 3.5 m of Tölgyessy, Dekan, Chovanec, Hubinský
    # (Evaluation of the Azure Kinect and Its Comparison to Kinect V1 and Kinect V2, Sensors 21,
    # 2021). As in Kurillo, Hemingway, Cheng, Cheng (Evaluating the Accuracy of the Azure Kinect
    # and Kinect v2, Sensors 22, 2022), it is like Kinect v2 at short range and better from 2.5 m.
    constant=0.0012,
    linear=0.0,
    square=0.0001,
    tilted=0.0001,
    # Our choice. According to Microsoft's description of the depth camera, pixels with signals
    # from more than one object are invalidated, mainly at edges.
    filtered_fraction=0.8,
)

TOF = TimeOfFlight(
    focal=focal_length(176, 43.6),
    area=1.5,  # our choice: light scatters in the lens
    # Our choice: about a centimetre at 2 to 3 m. It grows with the square of the distance because
    # of the returned light (Foix et al. 2011).
    constant=0.004,
    linear=0.0,
    square=0.0015,
    tilted=0.0002,
    filtered_fraction=0.0,
)


class RandomFields(NamedTuple):
    """The random numbers for one image.

    Attributes:
        shifts: row and column offsets of the sampled position of each pixel, shape (2, H, W).
        noise: normal, deviation 1, shape (H, W).
        drop: uniform in [0, 1), shape (H, W).
        gap: distance from a body to the wall that is assumed behind it, metres.
    """

    shifts: NDArray[np.float32]
    noise: NDArray[np.float32]
    drop: NDArray[np.float32]
    gap: float


def apply_time_of_flight(
    sensor: TimeOfFlight,
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
    fields = RandomFields(
        gap=random.uniform(*WALL_DISTANCE),
        shifts=np.float32(EDGE_JITTER)
        * np.stack([correlated_field(shape, JITTER_SPACING, random) for _ in range(2)]),
        noise=random.standard_normal(shape, dtype=np.float32),
        drop=random.random(shape, dtype=np.float32),
    )
    noisy = DepthImage(np.zeros(shape, np.float32), np.full(shape, NO_BODY, np.int32))
    expose(image, sensor, depth_range, camera, fields, noisy)
    return noisy


@exact_kernel
def expose(
    clean: DepthImage,
    sensor: TimeOfFlight,
    depth_range: DepthRange,
    camera: Intrinsics,
    fields: RandomFields,
    noisy: DepthImage,
) -> None:
    """Fill `noisy`, which is empty.

    A pixel whose area has the same surface, or nothing, in all corners shows its middle.
    """
    # Local variables: access to arrays in tuples is slow in a loop.
    depth, labels = clean
    noisy_depth, noisy_labels = noisy
    shifts, noise, drop = fields.shifts, fields.noise, fields.drop
    height, width = depth.shape
    half = 0.5 * sensor.area * camera.fx / sensor.focal
    focal = 0.5 * (camera.fx + camera.fy)
    for row in range(height):
        for column in range(width):
            y, x = row + shifts[0, row, column], column + shifts[1, row, column]
            if depth_difference(depth, y, x, half) > MIXED_PIXEL_DEPTH:
                if drop[row, column] < sensor.filtered_fraction:
                    continue
                z, at_row, at_column = mix_surfaces(depth, (y, x), half, fields.gap)
            else:
                at_row, at_column = nearest_pixel(y, height), nearest_pixel(x, width)
                z = float(depth[at_row, at_column])
            if z < depth_range.nearest:
                continue
            tilt = slope(depth, at_row, at_column, focal)
            # In units of the light from a surface at the end of the range that faces the sensor.
            light = (depth_range.farthest / z) ** 2 / math.sqrt(1.0 + tilt * tilt)
            if drop[row, column] >= light:
                continue
            error = noise_deviation(sensor, z, tilt) * noise[row, column]
            noisy_depth[row, column] = max(z + error, depth_range.nearest)
            noisy_labels[row, column] = labels[at_row, at_column]


@exact_kernel
def depth_difference(depth: NDArray[np.float32], row: float, column: float, half: float) -> float:
    """Return the range of depth at the corners of a square around a position, metres."""
    height, width = depth.shape
    above, below = nearest_pixel(row - half, height), nearest_pixel(row + half, height)
    left, right = nearest_pixel(column - half, width), nearest_pixel(column + half, width)
    a, b = depth[above, left], depth[above, right]
    c, d = depth[below, left], depth[below, right]
    difference: float = max(a, b, c, d) - min(a, b, c, d)
    return difference


@exact_kernel
def noise_deviation(sensor: TimeOfFlight, z: float, tilt: float) -> float:
    """Return the deviation of the noise at a distance and the tangent of an angle."""
    angle = min(math.atan(tilt), MAX_ANGLE)
    ratio = angle / (0.5 * math.pi - angle)
    straight = sensor.constant + sensor.linear * z + sensor.square * z * z
    return straight + sensor.tilted * z * math.sqrt(z) * ratio * ratio


@exact_kernel
def mix_surfaces(
    depth: NDArray[np.float32], middle: tuple[float, float], half: float, gap: float
) -> tuple[float, int, int]:
    """Return the measurement of a square around a position (row, column) with several surfaces.

    The weight of each surface is its area times the light that it returns, 1/z². That is the
    direction of the sum of the phasors if the phases differ little. Empty pixels count as a wall
    at `gap` behind the farthest surface; if the wall returns most of the light, nothing is
    measured.

    Returns:
        Depth, metres, or 0 for nothing; the row and the column of the pixel that returns most.
    """
    height, width = depth.shape
    top, bottom = middle[0] - half, middle[0] + half
    left, right = middle[1] - half, middle[1] + half
    light, weighted, empty = 0.0, 0.0, 0.0
    farthest, brightest, at_row, at_column = 0.0, 0.0, 0, 0
    for row in range(int(np.floor(top + 0.5)), int(np.floor(bottom + 0.5)) + 1):
        high = min(row + 0.5, bottom) - max(row - 0.5, top)
        for column in range(int(np.floor(left + 0.5)), int(np.floor(right + 0.5)) + 1):
            filled = high * (min(column + 0.5, right) - max(column - 0.5, left))
            in_row, in_column = min(max(row, 0), height - 1), min(max(column, 0), width - 1)
            z = float(depth[in_row, in_column])
            if z <= 0.0:
                empty += filled
                continue
            returned = filled / (z * z)
            light += returned
            weighted += returned * z
            farthest = max(farthest, z)
            if returned > brightest:
                brightest, at_row, at_column = returned, in_row, in_column
    wall = farthest + gap
    behind = empty / (wall * wall)
    if behind >= light:
        return 0.0, 0, 0
    return (weighted + behind * wall) / (light + behind), at_row, at_column
