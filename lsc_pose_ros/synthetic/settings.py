"""What synthetic frames shall show, checked before anything is drawn."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_mesh import AGES
from lsc_pose_ros.synthetic.body.population import Population
from lsc_pose_ros.synthetic.sensors.sensors import NOISES, SENSORS, Sensor

MOST_PEOPLE = 8

CLIP_LENGTH = 10
"""Frames in which the same people are seen, unless told otherwise."""

VIDEO_CLIP_LENGTH = 90
"""The same where the frames are a video."""

_STEEPEST = 45.0


class SyntheticSettings(NamedTuple):
    """What to generate.

    Attributes:
        frames: how many.
        seed: of everything that is drawn.
        people: in every frame.
        sensor: the depth camera, one of `SENSORS`; it has a size, a field of view and a noise.
        width: of the image, pixels; None: the sensor's.
        height: of the image, pixels; None: the sensor's.
        field_of_view: horizontal, degrees; None: the sensor's.
        noise: one of `NOISES`; None: the sensor's.
        yaw: people face at most so far aside of the camera, degrees; 180 is all round.
        distance: the nearest and the farthest that a person stands, metres.
        camera_height: the lowest and the highest that the camera is over the floor, metres.
        camera_tilt: by how little and by how much it looks down, degrees; negative is up.
        age: of the youngest and the oldest, years.
        stature: of the smallest and the tallest, metres.
        clip_length: new people come every so many frames; None: 10, or 90 in a video.
        rate: frames a second of smooth motion; None: frames have nothing to do with each other.
        cropped: people may be cut off by the image's edge.
        background: people are in a room with furniture.
        mocap: a folder of motion capture files, BVH, to draw poses or motion from.
        mocap_mapping: the file that says what their joints stand for; None: CMU's.
        mocap_share: of the people, those who move as in `mocap`.
        mocap_only: only these clips; names, or patterns such as 05_*; empty: all.
        mocap_without: none of these clips.
    """

    frames: int = 300
    seed: int = 0
    people: int = 1
    sensor: str = 'kinect_v1'
    width: int | None = None
    height: int | None = None
    field_of_view: float | None = None
    noise: str | None = None
    yaw: float = 60.0
    distance: tuple[float, float] = (1.5, 4.0)
    camera_height: tuple[float, float] = (0.5, 2.2)
    camera_tilt: tuple[float, float] = (-10.0, 30.0)
    age: tuple[float, float] = Population().age
    stature: tuple[float, float] = Population().stature
    clip_length: int | None = None
    rate: float | None = None
    cropped: bool = False
    background: bool = False
    mocap: Path | None = None
    mocap_mapping: Path | None = None
    mocap_share: float = 0.5
    mocap_only: tuple[str, ...] = ()
    mocap_without: tuple[str, ...] = ()


def sensor_of(settings: SyntheticSettings) -> Sensor:
    """Return the sensor, with whatever the settings change of it."""
    sensor = SENSORS[settings.sensor]
    changes = {
        name: getattr(settings, name)
        for name in ('width', 'height', 'field_of_view', 'noise')
        if getattr(settings, name) is not None
    }
    return sensor._replace(**changes)


def camera_of(settings: SyntheticSettings) -> Intrinsics:
    """Return the camera: square pixels, the principal point in the middle of the image."""
    sensor = sensor_of(settings)
    focal = 0.5 * sensor.width / np.tan(np.radians(0.5 * sensor.field_of_view))
    return Intrinsics(
        float(focal), float(focal), 0.5 * (sensor.width - 1), 0.5 * (sensor.height - 1)
    )


def clip_length_of(settings: SyntheticSettings) -> int:
    """Return after how many frames new people come."""
    if settings.clip_length is not None:
        return settings.clip_length
    return CLIP_LENGTH if settings.rate is None else VIDEO_CLIP_LENGTH


def check(settings: SyntheticSettings) -> None:
    """Check settings.

    Raises:
        InputError: one of them cannot be met.
    """
    if settings.sensor not in SENSORS:
        msg = f'sensor is {settings.sensor}; give one of {", ".join(SENSORS)}'
        raise InputError(msg)
    for met, complaint in (*_amounts(settings), *_views(settings), *_people(settings)):
        if not met:
            raise InputError(complaint)


_Demand = tuple[bool, str]


def _amounts(settings: SyntheticSettings) -> tuple[_Demand, ...]:
    length, rate = clip_length_of(settings), settings.rate
    return (
        (settings.frames >= 1, f'frames is {settings.frames}; give 1 or more'),
        (settings.seed >= 0, f'seed is {settings.seed}; give 0 or more'),
        (length >= 1, f'the clip length is {length} frames; give 1 or more'),
        (
            rate is None or 1 <= rate <= 1000,
            f'the rate is {rate or 0:g} frames a second; give 1 to 1000',
        ),
    )


def _views(settings: SyntheticSettings) -> tuple[_Demand, ...]:
    sensor = sensor_of(settings)
    near, far = settings.distance
    lowest, highest = settings.camera_height
    up, down = settings.camera_tilt
    return (
        (
            min(sensor.width, sensor.height) >= 16 and max(sensor.width, sensor.height) <= 4096,
            f'size is {sensor.width}x{sensor.height}; give 16x16 to 4096x4096 pixels',
        ),
        (
            10 <= sensor.field_of_view <= 150,
            f'the field of view is {sensor.field_of_view:g} degrees; give 10 to 150',
        ),
        (sensor.noise in NOISES, f'noise is {sensor.noise}; give one of {", ".join(NOISES)}'),
        (0 <= settings.yaw <= 180, f'yaw is {settings.yaw:g} degrees; give 0 to 180'),
        (
            0.5 <= near <= far <= 20,
            f'distance is {near:g} to {far:g} m; give the nearer first, both within 0.5 to 20',
        ),
        (
            0 <= lowest <= highest <= 5,
            (
                f'the camera height is {lowest:g} to {highest:g} m; give the lower first, both '
                f'within 0 to 5'
            ),
        ),
        (
            -_STEEPEST <= up <= down <= _STEEPEST,
            (
                f'the camera tilt is {up:g} to {down:g} degrees; give the smaller first, both '
                f'within {-_STEEPEST:g} (up) to {_STEEPEST:g} (down)'
            ),
        ),
    )


def _people(settings: SyntheticSettings) -> tuple[_Demand, ...]:
    small, tall = settings.stature
    young, old = settings.age
    return (
        (
            1 <= settings.people <= MOST_PEOPLE,
            f'people is {settings.people}; give 1 to {MOST_PEOPLE}',
        ),
        (
            0.8 <= small <= tall <= 2.2,
            f'stature is {small:g} to {tall:g} m; give the smaller first, both within 0.8 to 2.2',
        ),
        (
            AGES[0] <= young <= old <= AGES[-1],
            (
                f'age is {young:g} to {old:g} years; give the younger first, both within '
                f'{AGES[0]:g} to {AGES[-1]:g}'
            ),
        ),
        (
            0 <= settings.mocap_share <= 1,
            f'the share of motion capture is {settings.mocap_share:g}; give 0 to 1',
        ),
        (
            settings.mocap is not None or not settings.mocap_only + settings.mocap_without,
            'motion capture clips are named, but no folder of them is given',
        ),
    )
