"""Depth cameras: their images, their ranges and their noise."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.synthetic.scene.image import Image
from lsc_pose_ros.synthetic.sensors.optics import Range
from lsc_pose_ros.synthetic.sensors.time_of_flight import (
    AZURE,
    KINECT_V2,
    TOF,
    TimeOfFlight,
    measure_flight,
)
from lsc_pose_ros.synthetic.sensors.triangulation import (
    KINECT_V1,
    REALSENSE,
    ZED,
    Triangulation,
    triangulate,
)


class Sensor(NamedTuple):
    """A depth camera.

    Attributes:
        name: its own.
        width: of its image, pixels.
        height: of its image, pixels.
        field_of_view: horizontal, degrees.
        nearest: that it measures, metres.
        farthest: that it measures well, metres.
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
        # Half of 640x480, which is how its people were tracked. Range: Khoshelham, Elberink 2012.
        Sensor('kinect_v1', 320, 240, 58.5, 0.5, 5.0, 'kinect_v1'),
        # Microsoft's description: 0.5 to 4.5 m.
        Sensor('kinect_v2', 512, 424, 70.6, 0.5, 4.5, 'kinect_v2'),
        # Mode NFOV unbinned of Microsoft's hardware specification.
        Sensor('azure', 640, 576, 75.0, 0.5, 3.86, 'azure'),
        # D435; its data sheet: up to about 10 m.
        Sensor('realsense', 848, 480, 87.0, 0.3, 10.0, 'realsense'),
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
    'zed': ZED,
    'tof': TOF,
}

NOISES = (*_MODELS, 'none')
"""Names of noises; 'none' leaves an image as it is."""


def sense(noise: str, image: Image, camera: Intrinsics, random: np.random.Generator) -> Image:
    """Return `image` as a sensor sees it; what drops out has depth 0 and no body.

    A pixel's label is that of the surface that it shows.

    Args:
        noise: one of NOISES.
        image: of any size, with or without a background (depth, but no body).
        camera: of the image.
        random: is asked for numbers always in the same order, so the same state gives the same
            image.
    """
    if noise == 'none':
        return image
    model, sensor = _MODELS[noise], SENSORS[noise]
    reach = Range(sensor.nearest, sensor.farthest)
    if isinstance(model, Triangulation):
        return triangulate(model, reach, image, camera, random)
    return measure_flight(model, reach, image, camera, random)
