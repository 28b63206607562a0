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

"""Depth cameras with image size, field of view, range and noise."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.sensors.optics import DepthRange
from lsc_pose_ros.synthetic.sensors.time_of_flight import (
    AZURE,
    KINECT_V2,
    TOF,
    TimeOfFlight,
    apply_time_of_flight,
)
from lsc_pose_ros.synthetic.sensors.triangulation import (
    apply_triangulation,
)
from lsc_pose_ros.synthetic.sensors.triangulation_sensors import (
    KINECT_V1,
    REALSENSE,
    REALSENSE_FILTERED,
    ZED,
    Triangulation,
)


class Sensor(NamedTuple):
    """A depth camera.

    Attributes:
        name: of the sensor.
        width: of its image, pixels.
        height: of its image, pixels.
        field_of_view: horizontal, degrees.
        nearest: smallest distance that it measures, metres.
        farthest: largest distance that it measures reliably, metres.
        noise: the name of its noise, one of NOISES.
    """

    name: str
    width: int
    height: int
    field_of_view: float
    nearest: float
    farthest: float
    noise: str


SENSORS: dict[str, Sensor] = {
    sensor.name: sensor
    for sensor in (
        # Half of 640x480, the resolution of its tracker. Range: Khoshelham, Elberink 2012.
        Sensor('kinect_v1', 320, 240, 58.5, 0.5, 5.0, 'kinect_v1'),
        # Microsoft's description: 0.5 to 4.5 m.
        Sensor('kinect_v2', 512, 424, 70.6, 0.5, 4.5, 'kinect_v2'),
        # Mode NFOV unbinned of Microsoft's hardware specification.
        Sensor('azure', 640, 576, 75.0, 0.5, 3.86, 'azure'),
        # D435; its data sheet: up to about 10 m.
        Sensor('realsense', 848, 480, 87.0, 0.3, 10.0, 'realsense'),
        # D435, aligned to its colour camera (69 degrees wide at 16:9, here 4:3).
        Sensor('realsense_filtered', 640, 480, 54.8, 0.3, 10.0, 'realsense_filtered'),
        # ZED 2, mode WVGA; its data sheet: 0.3 to 20 m.
        Sensor('zed', 672, 376, 87.0, 0.3, 20.0, 'zed'),
        # Like a SwissRanger SR4000, which measures distances modulo 5 m.
        Sensor('tof', 176, 144, 43.6, 0.3, 5.0, 'tof'),
    )
}
"""Sensors by name."""

_MODELS: dict[str, Triangulation | TimeOfFlight] = {
    'kinect_v1': KINECT_V1,
    'kinect_v2': KINECT_V2,
    'azure': AZURE,
    'realsense': REALSENSE,
    'realsense_filtered': REALSENSE_FILTERED,
    'zed': ZED,
    'tof': TOF,
}

NOISES = (*_MODELS, 'none')
"""Names of the noise models; 'none' leaves an image unchanged."""


def apply_sensor(
    noise: str, image: DepthImage, camera: Intrinsics, random: np.random.Generator
) -> DepthImage:
    """Return `image` with a sensor's noise; pixels that are lost have depth 0 and no body.

    A pixel's label is that of the surface that its depth shows.

    Args:
        noise: one of NOISES.
        image: of any size, with or without a background (depth without a body).
        camera: the image's intrinsics.
        random: the generator; the sequence of its calls depends only on noise and image size.
    """
    if noise == 'none':
        return image
    model, sensor = _MODELS[noise], SENSORS[noise]
    depth_range = DepthRange(sensor.nearest, sensor.farthest)
    if isinstance(model, Triangulation):
        return apply_triangulation(model, depth_range, image, camera, random)
    return apply_time_of_flight(model, depth_range, image, camera, random)
