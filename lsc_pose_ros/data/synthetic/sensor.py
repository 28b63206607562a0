"""What a Kinect makes of a perfect depth image.

Three effects, in the order in which the sensor has them:

- Edges waver: a pixel shows what is about half a pixel away, in a random direction.
- Surfaces seen at a grazing angle, the rims of limbs among them, return too little of the
  pattern and drop out now and then.
- The sensor measures disparity in eighths of a pixel: d = round(k / z + noise), z = k / d.

The first and the third are the model of Barron and Malik, Intrinsic Scene Properties from a
Single RGB-D Image (CVPR 2013), with the constants of Handa et al., A Benchmark for RGB-D Visual
Odometry, 3D Reconstruction and SLAM (ICRA 2014); the step they give, 2.8 mm times the squared
distance in metres, is what Khoshelham and Elberink measured (Sensors 12, 2012). That surfaces get
lost beyond some 70 degrees is seen in Nguyen, Izadi, Lovell, Modeling Kinect Sensor Noise
(3DIMPVT 2012); the share that drops out is ours.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.data.synthetic.render import Image

DISPARITY = 351.3
"""Focal length times baseline times eight steps a pixel, in metres: the k of z = k / d."""

SHIFT_DEVIATION = 0.5
"""Of the sideways shift along each axis, pixels of the sensor's own SENSOR_WIDTH columns."""

SENSOR_WIDTH = 640

DISPARITY_DEVIATION = 1.0 / 6.0
"""Of the noise on disparity, in steps."""

GRAZING = math.tan(math.radians(75.0))
"""The slope of a surface, tangent of the angle between its normal and the ray, that may drop."""

DROPOUT = 0.15
"""The share of grazing pixels that drop out."""


class Chances(NamedTuple):
    """What is drawn for one image.

    Attributes:
        shifts: rows and columns by which each pixel looks aside, shape (2, H, W).
        steps: added to disparity, shape (H, W).
        drop: uniform in [0, 1): below DROPOUT a grazing pixel drops out, shape (H, W).
    """

    shifts: NDArray[np.float32]
    steps: NDArray[np.float32]
    drop: NDArray[np.float32]


def kinect_noise(image: Image, camera: Intrinsics, random: np.random.Generator) -> Image:
    """Return `image` as a Kinect sees it; what drops out has depth 0 and no body."""
    shape = image.depth.shape
    aside = np.float32(SHIFT_DEVIATION * shape[1] / SENSOR_WIDTH)
    chances = Chances(
        shifts=aside * random.standard_normal((2, *shape), dtype=np.float32),
        steps=np.float32(DISPARITY_DEVIATION) * random.standard_normal(shape, dtype=np.float32),
        drop=random.random(shape, dtype=np.float32),
    )
    noisy = Image(np.zeros(shape, np.float32), np.full(shape, NO_BODY, np.int32))
    disturb(image, chances, 0.5 * (camera.fx + camera.fy), noisy)
    return noisy


@kernel
def disturb(clean: Image, chances: Chances, focal: float, noisy: Image) -> None:
    """Fill `noisy`, which is empty before, from `clean`; `focal` is in pixels."""
    height, width = clean.depth.shape
    for row in range(height):
        for column in range(width):
            from_row = int(np.floor(row + np.float64(chances.shifts[0, row, column]) + 0.5))
            from_column = int(np.floor(column + np.float64(chances.shifts[1, row, column]) + 0.5))
            from_row = min(max(from_row, 0), height - 1)
            from_column = min(max(from_column, 0), width - 1)
            z = np.float64(clean.depth[from_row, from_column])
            if z <= 0.0:
                continue
            may_drop = chances.drop[row, column] < DROPOUT
            if may_drop and slope(clean.depth, from_row, from_column, focal) > GRAZING:
                continue
            disparity = np.floor(DISPARITY / z + np.float64(chances.steps[row, column]) + 0.5)
            if disparity < 1.0:
                continue
            noisy.depth[row, column] = DISPARITY / disparity
            noisy.labels[row, column] = clean.labels[from_row, from_column]


@kernel
def slope(clean: NDArray[np.float32], row: int, column: int, focal: float) -> float:
    """Return the surface's slope at a pixel: the change of depth over the size of a pixel.

    Along each axis the larger of the two one-sided differences; an empty neighbour counts as
    a cliff, one outside the image not at all.
    """
    height, width = clean.shape
    z = float(clean[row, column])
    steepest_down, steepest_right = 0.0, 0.0
    for step in (-1, 1):
        if 0 <= row + step < height:
            other = float(clean[row + step, column])
            change = abs(other - z) if other > 0.0 else math.inf
            steepest_down = max(steepest_down, change)
        if 0 <= column + step < width:
            other = float(clean[row, column + step])
            change = abs(other - z) if other > 0.0 else math.inf
            steepest_right = max(steepest_right, change)
    return math.sqrt(steepest_down**2 + steepest_right**2) * focal / z
