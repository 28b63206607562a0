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

"""Parameters of the sensors that measure disparity: Kinect v1, RealSense D435 and ZED 2."""

import math
from typing import NamedTuple

from lsc_pose_ros.synthetic.sensors.optics import focal_length


class Triangulation(NamedTuple):
    """A sensor that measures disparity; pixels are those of its own full image.

    Attributes:
        focal: focal length, pixels.
        baseline: from the camera to the second viewpoint, on its right, metres.
        cameras: 2, or 1 if the second viewpoint is a projector.
        step: rounding step of 1/z, 1/m.
        deviation: of the noise of 1/z before rounding, 1/m.
        window: correlation length of this noise, pixels.
        edge_jitter: deviation of the displacement of edges along each axis, pixels.
        fattening: mean growth of edges outwards, pixels.
        averaging: half the width of the averaging window, pixels.
        max_difference: surfaces whose 1/z differs more are not averaged, and the nearer one grows,
            1/m.
        grazing_angle: surfaces with larger angles are increasingly lost, degrees.
        dropout: fraction of pixels that is lost anyway.
        smoothing: largest deviation of the blur that the driver applies, pixels; the deviation is
            random from image to image.
        filling: widest hole that the driver fills, pixels.
    """

    focal: float
    baseline: float
    cameras: int
    step: float
    deviation: float
    window: float
    edge_jitter: float
    fattening: float
    averaging: float
    max_difference: float
    grazing_angle: float
    dropout: float
    smoothing: float = 0.0
    filling: float = 0.0


KINECT_V1 = Triangulation(
    focal=focal_length(640, 58.5),
    # Khoshelham and Elberink 2012, section 3: an error of half a step, which includes the
    # rounding error of 1 / sqrt(12).
    baseline=0.075,
    cameras=1,
    # 351.3 / z: Barron and Malik, Intrinsic Scene Properties from a Single RGB-D Image, CVPR
    # 2013; Handa et al., A Benchmark for RGB-D Visual Odometry, 3D Reconstruction and SLAM, 2014.
    step=1 / 351.3,
    deviation=math.sqrt(0.5**2 - 1 / 12) / 351.3,
    # Our choice: in UTD-MHAD, noise is correlated over 2 to 3 pixels of 320.
    window=5.0,
    # Nguyen, Izadi, Lovell, Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
    # Tracking, 3DIMPVT 2012: 0.8 pixels, at angles up to some 60 to 70 degrees.
    edge_jitter=0.8,
    fattening=0.0,
    averaging=0.0,
    max_difference=0.0,
    grazing_angle=70.0,
    dropout=0.0,
)

REALSENSE = Triangulation(
    # D435, from its data sheet: 87 degrees, 50 mm.
    focal=focal_length(848, 87.0),
    baseline=0.050,
    cameras=2,
    # Intel's guide (Grunnet-Jepsen, Sweetser, Woodfill, Tuning depth cameras for best
    # performance) gives the error of z as z² subpixel / (focal baseline). Its author gives 0.08
    # as a typical subpixel and 0.032, 1/32, as the best (librealsense, issue 3904).
    step=1 / 32 / (focal_length(848, 87.0) * 0.050),
    deviation=0.08 / (focal_length(848, 87.0) * 0.050),
    # Our choice, all below: windows of a census transform as in Keselman et al., Intel RealSense
    # Stereoscopic Depth Cameras, CVPR workshops 2017.
    window=9.0,
    edge_jitter=1.0,
    fattening=1.5,
    averaging=2.0,
    max_difference=0.03,
    grazing_angle=70.0,
    dropout=0.01,
)

REALSENSE_FILTERED = REALSENSE._replace(
    # Our choice, fitted to recordings of a D435 whose driver decimates, smooths and fills: the
    # edges of people are ramps of up to 25 pixels, few pixels are lost, and the error of 1/z of
    # 0.0024 1/m is correlated over some 20 pixels of 640.
    window=26.0,
    deviation=0.16 / (focal_length(848, 87.0) * 0.050),
    smoothing=6.5,
    filling=16.0,
)
"""RealSense D435 with the post-processing of its driver."""

ZED = Triangulation(
    # ZED 2 in its mode WVGA, from its data sheet: 87 degrees, 120 mm.
    focal=focal_length(672, 87.0),
    baseline=0.120,
    cameras=2,
    # Our choice: negligible, because the sensor publishes floating-point depth.
    step=1 / 256 / (focal_length(672, 87.0) * 0.120),
    # The data sheet: within 1 % at 3 m and 5 % at 15 m, both are z² / 300 m. Ortiz, Cabrera,
    # Gonçalves, Depth Data Error Modeling of the ZED 3D Vision Sensor from Stereolabs, ELCVIA 17,
    # 2018, find the same growth with a constant per resolution.
    deviation=1 / 300,
    # Our choice, all below: windows of passive stereo are larger, and surfaces without texture
    # are filled from their neighbours, not lost.
    window=16.0,
    edge_jitter=1.5,
    fattening=2.0,
    averaging=4.0,
    max_difference=0.06,
    grazing_angle=80.0,
    dropout=0.0,
)
