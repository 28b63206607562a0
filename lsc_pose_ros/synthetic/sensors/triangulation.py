"""Noise of sensors that measure disparity: structured light, active and passive stereo.

All of them see a surface from two places, one of which may be a projector, and find how far its
image moves between them. They measure 1/z, so the error of z grows with the square of the distance
(Khoshelham and Elberink, Accuracy and Resolution of Kinect Depth Data, Sensors 12, 2012), and
their effects come in this order:

1. What the second place cannot see is not measured: a shadow at the left of whatever stands in
   front, for the second place is to the right. Of two cameras, the second sees none of the image's
   left margin. What is seen at a grazing angle, is far away, or offers no texture is lost.
2. A match is that of a whole window about a pixel. So edges waver, and where windows are large,
   what is in front grows: edge fattening (Scharstein and Szeliski, A Taxonomy and Evaluation of
   Dense Two-Frame Stereo Correspondence Algorithms, IJCV 47, 2002, section 5).
3. Surfaces that are not far apart are averaged over the window.
4. Noise, alike for pixels whose windows overlap, is added to 1/z, which is rounded to a step.
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

HALF = 0.5
"""What a pixel shows reaches so far to either side of its centre, pixels."""

FADING = 0.25
"""Beyond the range more and more is lost, all of it farther away by this share of it; ours."""

LOGISTIC = 1.702
"""The logistic function of so many deviations is the normal distribution within 0.01."""

CERTAIN = 0.999
"""A share of losses from here on is all."""


class Triangulation(NamedTuple):
    """A sensor that measures disparity; pixels are those of its own full image.

    Attributes:
        focal: focal length, pixels.
        baseline: from the camera to the second place, on its right, metres.
        cameras: 2, or 1 if the second place is that of a projector.
        step: to which 1/z is rounded, 1/m.
        deviation: of the noise of 1/z before that, 1/m.
        window: over which this noise is alike, pixels.
        waver: deviation of the sideways shift of edges along each axis, pixels.
        fringe: edges grow outwards by so much on average, pixels.
        averaging: half the width over which surfaces are averaged, pixels.
        apart: surfaces whose 1/z differs by more are not averaged, and the nearer one grows, 1/m.
        grazing: surfaces turned away by more than this angle are lost more and more, degrees.
        patches: the share of surfaces that is lost anyway.
    """

    focal: float
    baseline: float
    cameras: int
    step: float
    deviation: float
    window: float
    waver: float
    fringe: float
    averaging: float
    apart: float
    grazing: float
    patches: float


KINECT_V1 = Triangulation(
    focal=focal_length(640, 58.5),
    # Khoshelham and Elberink 2012, section 3; their error of half a step, of which the
    # rounding itself makes 1 / sqrt(12).
    baseline=0.075,
    cameras=1,
    # 351.3 / z: Barron and Malik, Intrinsic Scene Properties from a Single RGB-D Image, CVPR
    # 2013; Handa et al., A Benchmark for RGB-D Visual Odometry, 3D Reconstruction and SLAM, 2014.
    step=1 / 351.3,
    deviation=math.sqrt(0.5**2 - 1 / 12) / 351.3,
    # Ours: in UTD-MHAD it is alike over 2 to 3 pixels of 320.
    window=5.0,
    # Nguyen, Izadi, Lovell, Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
    # Tracking, 3DIMPVT 2012: 0.8 pixels, at angles up to some 60 to 70 degrees.
    waver=0.8,
    fringe=0.0,
    averaging=0.0,
    apart=0.0,
    grazing=70.0,
    patches=0.0,
)

REALSENSE = Triangulation(
    # Of a D435, from its data sheet: 87 degrees, 50 mm.
    focal=focal_length(848, 87.0),
    baseline=0.050,
    cameras=2,
    # Intel's guide (Grunnet-Jepsen, Sweetser, Woodfill, Tuning depth cameras for best
    # performance) gives the error of z as z² subpixel / (focal baseline), its author 0.08 as the
    # subpixel to reckon with and 0.032, a thirty-second, as the best (librealsense, issue 3904).
    step=1 / 32 / (focal_length(848, 87.0) * 0.050),
    deviation=0.08 / (focal_length(848, 87.0) * 0.050),
    # Ours, all below: windows of a census transform as in Keselman et al., Intel RealSense
    # Stereoscopic Depth Cameras, CVPR workshops 2017.
    window=9.0,
    waver=1.0,
    fringe=1.5,
    averaging=2.0,
    apart=0.03,
    grazing=70.0,
    patches=0.01,
)

ZED = Triangulation(
    # Of a ZED 2 in its mode WVGA, from its data sheet: 87 degrees, 120 mm.
    focal=focal_length(672, 87.0),
    baseline=0.120,
    cameras=2,
    # Ours: fine enough to be invisible, as depth comes in floating-point numbers.
    step=1 / 256 / (focal_length(672, 87.0) * 0.120),
    # The data sheet: within 1 % at 3 m and 5 % at 15 m, both of which are z² / 300 m. The same
    # growth, with constants for each resolution, in Ortiz, Cabrera, Gonçalves, Depth Data Error
    # Modeling of the ZED 3D Vision Sensor from Stereolabs, ELCVIA 17, 2018.
    deviation=1 / 300,
    # Ours, all below: passive, so windows are larger, and what has no texture is filled from
    # its neighbours rather than lost.
    window=16.0,
    waver=1.5,
    fringe=2.0,
    averaging=4.0,
    apart=0.06,
    grazing=80.0,
    patches=0.0,
)


class Disparities(NamedTuple):
    """What a sensor sees on its way from distances to distances.

    Attributes:
        near: 1/z, 1/m; 0 where there is nothing, negative what is lost, shape (H, W).
        labels: the body that a pixel shows, or NO_BODY, shape (H, W).
    """

    near: NDArray[np.float32]
    labels: NDArray[np.int32]


def triangulate(
    sensor: Triangulation,
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
    scale = camera.fx / sensor.focal
    window = sensor.window * scale
    lost = grain(shape, window, random)
    shifts = np.stack([grain(shape, window, random) for _ in range(2)])
    growth = grain(shape, window, random)
    noise = grain(shape, window, random)
    seen = Disparities(np.empty(shape, np.float32), image.labels)
    look(image.depth, sensor, reach, camera, lost, seen.near)
    matched = Disparities(np.empty(shape, np.float32), np.empty(shape, np.int32))
    fringe = np.float32(sensor.fringe * scale) * (1 + np.float32(0.5) * growth)
    match(seen, np.float32(sensor.waver * scale) * shifts, fringe, sensor.apart, matched)
    averaged = average(matched.near, round(sensor.averaging * scale), sensor.apart)
    noisy = Image(np.empty(shape, np.float32), matched.labels)
    measure(averaged, noise, sensor, noisy)
    return noisy


@exact_kernel
def look(
    depth: NDArray[np.float32],
    sensor: Triangulation,
    reach: Range,
    camera: Intrinsics,
    lost: NDArray[np.float32],
    near: NDArray[np.float32],
) -> None:
    """Write 1/z, negative if it is lost to the second place, the angle, the range or by chance.

    From the second place a pixel of column u is seen at u - fx baseline / z. Of two surfaces in
    one row that it sees in another order than the camera, the farther one counts as hidden: an
    exact shadow but for things thinner than their own, and the ordering constraint of matching.
    """
    height, width = depth.shape
    move = camera.fx * sensor.baseline
    steep = math.tan(math.radians(sensor.grazing))
    focal = 0.5 * (camera.fx + camera.fy)
    anyway = quantile(sensor.patches)
    for row in range(height):
        leftmost = math.inf
        for column in range(width - 1, -1, -1):
            near[row, column] = 0.0
            z = float(depth[row, column])
            if z <= 0.0:
                continue
            near[row, column] = -1.0 / z
            place = column - move / z
            hidden = place > leftmost - HALF or (sensor.cameras == 2 and place < -HALF)
            leftmost = min(leftmost, place)
            if hidden or z < reach.nearest:
                continue
            loss = max(0.0, (z / reach.farthest - 1.0) / FADING)
            tilt = slope(depth, row, column, focal)
            if tilt > steep:
                loss += 1.0 - steep / tilt
            below = anyway if loss == 0.0 else quantile(sensor.patches + loss)
            if lost[row, column] >= below:
                near[row, column] = 1.0 / z


@exact_kernel
def quantile(share: float) -> float:
    """Return the number below which normal noise is with a probability, all of it if near 1."""
    if share <= 0.0:
        return -math.inf
    if share >= CERTAIN:
        return math.inf
    return math.log(share / (1.0 - share)) / LOGISTIC


@exact_kernel
def match(
    seen: Disparities,
    shifts: NDArray[np.float32],
    fringe: NDArray[np.float32],
    apart: float,
    matched: Disparities,
) -> None:
    """Let edges waver and grow: each pixel shows what is aside of it, or in front beside that.

    Args:
        seen: what the sensor sees, or loses.
        shifts: rows and columns by which each pixel looks aside, shape (2, H, W).
        fringe: by how much an edge grows over each pixel, pixels, shape (H, W).
        apart: by how much the 1/z of what grows is greater, 1/m.
        matched: is filled; what is lost is nothing.
    """
    near, labels = seen
    matched_near, matched_labels = matched
    height, width = near.shape
    for row in range(height):
        for column in range(width):
            at_row = nearest_pixel(row + shifts[0, row, column], height)
            at_column = nearest_pixel(column + shifts[1, row, column], width)
            best = near[at_row, at_column]
            label = labels[at_row, at_column]
            radius = int(np.floor(fringe[row, column] + 0.5))
            if radius > 0:
                least = abs(best) + apart
                for down, right in ((-radius, 0), (radius, 0), (0, -radius), (0, radius)):
                    to_row = min(max(at_row + down, 0), height - 1)
                    to_column = min(max(at_column + right, 0), width - 1)
                    if near[to_row, to_column] > max(best, least):
                        best = near[to_row, to_column]
                        label = labels[to_row, to_column]
            matched_near[row, column] = max(best, 0.0)
            matched_labels[row, column] = label


def average(near: NDArray[np.float32], radius: int, apart: float) -> NDArray[np.float32]:
    """Average 1/z over a square, along rows and then along columns.

    Args:
        near: 1/z, 0 where there is nothing, shape (H, W).
        radius: half the square's width, pixels.
        apart: pixels whose 1/z differs by more from the middle's are left out.

    Returns:
        The averages, shape (H, W); where there is nothing, nothing is added.
    """
    if radius < 1:
        return near
    for down, right in ((0, 1), (1, 0)):
        averaged = np.empty_like(near)
        average_along(near, radius, apart, (down, right), averaged)
        near = averaged
    return near


@exact_kernel
def average_along(
    near: NDArray[np.float32],
    radius: int,
    apart: float,
    direction: tuple[int, int],
    averaged: NDArray[np.float32],
) -> None:
    """Fill `averaged` with the average along a direction, rows and columns to go each step."""
    height, width = near.shape
    down, right = direction
    for row in range(height):
        for column in range(width):
            middle = near[row, column]
            averaged[row, column] = middle
            if middle <= 0.0:
                continue
            place = row * down + column * right
            last = (height - 1) * down + (width - 1) * right
            total, count = 0.0, 0
            for step in range(-min(radius, place), min(radius, last - place) + 1):
                other = near[row + step * down, column + step * right]
                if other > 0.0 and abs(other - middle) <= apart:
                    total += other
                    count += 1
            averaged[row, column] = total / count


@exact_kernel
def measure(
    near: NDArray[np.float32],
    noise: NDArray[np.float32],
    sensor: Triangulation,
    noisy: Image,
) -> None:
    """Add noise to 1/z and round it; labels go where nothing is measured."""
    depth, labels = noisy
    height, width = near.shape
    for row in range(height):
        for column in range(width):
            whole = 0.0
            if near[row, column] > 0.0:
                steps = (near[row, column] + sensor.deviation * noise[row, column]) / sensor.step
                whole = np.floor(steps + 0.5)
            if whole >= 1.0:
                depth[row, column] = 1.0 / (whole * sensor.step)
            else:
                depth[row, column] = 0.0
                labels[row, column] = NO_BODY
