"""Noise of sensors that measure how long light travels.

Their effects, in this order:

1. A pixel gathers light from an area. At an edge it sees two surfaces and measures something
   in between: flying pixels (Foix, Alenyà, Torras, Lock-in Time-of-Flight (ToF) Cameras: A Survey,
   IEEE Sensors Journal 11, 2011). The nearer surface returns more light, as 1/z². Some sensors
   notice part of that and drop the pixel.
2. What returns too little light, far away or turned away, is lost.
3. Noise of its own for each pixel, more for what is far away or turned away.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.image import Image
from lsc_pose_ros.synthetic.sensors.correlated_noise import grain
from lsc_pose_ros.synthetic.sensors.optics import Range, focal_length, nearest_pixel, slope

BEHIND = (1.0, 3.0)
"""Where an image shows nothing, a wall is assumed so far behind its neighbours, metres; ours."""

UNKNOWN = 0.35
"""Deviation of where within a pixel its edges are, pixels of the image: a rendered image does not
tell; ours."""

WAVER_GRID = 3.0
"""Over so many pixels of the image they are alike; ours."""

EDGE = 0.05
"""Surfaces so far apart within one pixel's area, metres, make it fly; ours."""

STEEPEST = math.radians(80.0)
"""The formula for noise by angle is infinite at 90 degrees; beyond this it stays; ours."""


class TimeOfFlight(NamedTuple):
    """A sensor that measures how long light travels; pixels are those of its own full image.

    The deviation of the noise, metres, at distance z, metres, and angle θ is
    constant + linear z + square z² + tilted z^1.5 (θ / (π/2 - θ))².

    Attributes:
        focal: focal length, pixels.
        area: width of the area that a pixel sees, pixels.
        constant: see above.
        linear: see above.
        square: see above.
        tilted: see above.
        filtered: the share of flying pixels that the sensor drops itself.
    """

    focal: float
    area: float
    constant: float
    linear: float
    square: float
    tilted: float
    filtered: float


KINECT_V2 = TimeOfFlight(
    focal=focal_length(512, 70.6),
    area=1.0,  # ours
    # Fankhauser, Bloesch, Rodriguez, Kaestner, Hutter, Siegwart, Kinect v2 for Mobile Robot
    # Navigation: Evaluation and Modeling, ICAR 2015.
    constant=0.0015,
    linear=-0.0005,
    square=0.0003,
    tilted=0.0001,
    filtered=0.5,  # ours
)

AZURE = TimeOfFlight(
    focal=focal_length(640, 75.0),
    area=1.0,  # ours
    # Ours: well within the 17 mm up to 3.5 m that Tölgyessy, Dekan, Chovanec, Hubinský confirm
    # (Evaluation of the Azure Kinect and Its Comparison to Kinect V1 and Kinect V2, Sensors 21,
    # 2021), and like Kinect v2 near, better beyond 2.5 m, as Kurillo, Hemingway, Cheng, Cheng
    # find (Evaluating the Accuracy of the Azure Kinect and Kinect v2, Sensors 22, 2022).
    constant=0.0012,
    linear=0.0,
    square=0.0001,
    tilted=0.0001,
    # Ours: Microsoft's description of the depth camera says that pixels with signals from more
    # than one object are invalidated, at edges above all.
    filtered=0.8,
)

TOF = TimeOfFlight(
    focal=focal_length(176, 43.6),
    area=1.5,  # ours: light scatters in the lens
    # Ours: about a centimetre at 2 to 3 m; that it grows with the square of the distance is due
    # to the light that is returned (Foix et al. 2011).
    constant=0.004,
    linear=0.0,
    square=0.0015,
    tilted=0.0002,
    filtered=0.0,
)


class Chances(NamedTuple):
    """What is drawn for one image.

    Attributes:
        shifts: rows and columns by which each pixel looks aside, shape (2, H, W).
        noise: normal, deviation 1, shape (H, W).
        drop: uniform in [0, 1), shape (H, W).
        gap: from a body to the wall where there is nothing behind it, metres.
    """

    shifts: NDArray[np.float32]
    noise: NDArray[np.float32]
    drop: NDArray[np.float32]
    gap: float


def measure_flight(
    sensor: TimeOfFlight,
    reach: Range,
    image: Image,
    camera: Intrinsics,
    random: np.random.Generator,
) -> Image:
    """Return `image` as `sensor` sees it; what it does not measure has depth 0 and no body.

    Args:
        sensor: the sensor.
        reach: its range.
        image: of any size; effects that are given in pixels follow the focal length.
        camera: of the image.
        random: is asked for numbers always in the same order.
    """
    shape = image.depth.shape
    chances = Chances(
        gap=random.uniform(*BEHIND),
        shifts=np.float32(UNKNOWN)
        * np.stack([grain(shape, WAVER_GRID, random) for _ in range(2)]),
        noise=random.standard_normal(shape, dtype=np.float32),
        drop=random.random(shape, dtype=np.float32),
    )
    noisy = Image(np.zeros(shape, np.float32), np.full(shape, NO_BODY, np.int32))
    expose(image, sensor, reach, camera, chances, noisy)
    return noisy


@exact_kernel
def expose(
    clean: Image,
    sensor: TimeOfFlight,
    reach: Range,
    camera: Intrinsics,
    chances: Chances,
    noisy: Image,
) -> None:
    """Fill `noisy`, which is empty before.

    A pixel whose area has one surface, or nothing, in all its corners shows what is in the middle.
    """
    # Arrays within tuples are slow to reach in a loop.
    depth, labels = clean
    noisy_depth, noisy_labels = noisy
    shifts, noise, drop = chances.shifts, chances.noise, chances.drop
    height, width = depth.shape
    half = 0.5 * sensor.area * camera.fx / sensor.focal
    focal = 0.5 * (camera.fx + camera.fy)
    for row in range(height):
        for column in range(width):
            y, x = row + shifts[0, row, column], column + shifts[1, row, column]
            above, below = nearest_pixel(y - half, height), nearest_pixel(y + half, height)
            left, right = nearest_pixel(x - half, width), nearest_pixel(x + half, width)
            a, b = depth[above, left], depth[above, right]
            c, d = depth[below, left], depth[below, right]
            if max(a, b, c, d) - min(a, b, c, d) > EDGE:
                if drop[row, column] < sensor.filtered:
                    continue
                z, at_row, at_column = mix(depth, (y, x), half, chances.gap)
            else:
                at_row, at_column = nearest_pixel(y, height), nearest_pixel(x, width)
                z = float(depth[at_row, at_column])
            if z < reach.nearest:
                continue
            tilt = slope(depth, at_row, at_column, focal)
            # Of the light that a surface at the end of the range returns if it faces the sensor.
            light = (reach.farthest / z) ** 2 / math.sqrt(1.0 + tilt * tilt)
            if drop[row, column] >= light:
                continue
            error = deviation(sensor, z, tilt) * noise[row, column]
            noisy_depth[row, column] = max(z + error, reach.nearest)
            noisy_labels[row, column] = labels[at_row, at_column]


@exact_kernel
def deviation(sensor: TimeOfFlight, z: float, tilt: float) -> float:
    """Return the deviation of the noise at a distance and the tangent of an angle."""
    angle = min(math.atan(tilt), STEEPEST)
    turned = angle / (0.5 * math.pi - angle)
    straight = sensor.constant + sensor.linear * z + sensor.square * z * z
    return straight + sensor.tilted * z * math.sqrt(z) * turned * turned


@exact_kernel
def mix(
    depth: NDArray[np.float32], middle: tuple[float, float], half: float, gap: float
) -> tuple[float, int, int]:
    """Return what a square about a place (row, column) measures of all surfaces in it together.

    Each surface counts by the area it fills times the light it returns, 1/z². That is the
    direction in which the sum of their phasors points, as long as their phases differ little.
    Where there is nothing, a wall is assumed `gap` behind the farthest of the others; if it
    returns most of the light, nothing is measured.

    Returns:
        Depth, metres, or 0 for nothing; the row and the column of the pixel that returns most.
    """
    height, width = depth.shape
    top, bottom = middle[0] - half, middle[0] + half
    left, right = middle[1] - half, middle[1] + half
    light, together, empty = 0.0, 0.0, 0.0
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
            together += returned * z
            farthest = max(farthest, z)
            if returned > brightest:
                brightest, at_row, at_column = returned, in_row, in_column
    wall = farthest + gap
    behind = empty / (wall * wall)
    if behind >= light:
        return 0.0, 0, 0
    return (together + behind * wall) / (light + behind), at_row, at_column
