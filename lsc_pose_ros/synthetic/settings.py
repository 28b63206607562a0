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

"""Settings of the synthetic generator and their checks."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_mesh import AGES
from lsc_pose_ros.synthetic.body.population import Population
from lsc_pose_ros.synthetic.sensors.sensors import NOISES, SENSORS, Sensor

MAX_PEOPLE = 8

CLIP_LENGTH = 10
"""Default number of successive frames with the same people."""

VIDEO_CLIP_LENGTH = 90
"""Default number of successive frames with the same people in a video."""

_MAX_TILT = 45.0


class SyntheticSettings(NamedTuple):
    """What to generate.

    Attributes:
        frames: number of frames.
        seed: of all random numbers.
        people: number of people in each frame.
        sensor: the depth camera, one of `SENSORS`; it defines size, field of view and noise.
        width: of the image, pixels; None is the sensor's.
        height: of the image, pixels; None is the sensor's.
        field_of_view: horizontal, degrees; None is the sensor's.
        noise: one of `NOISES`; None is the sensor's.
        yaw: largest angle between the direction that people face and the camera, degrees; 180 is
            all around.
        distance: smallest and largest distance of a person, metres.
        camera_height: smallest and largest height of the camera above the floor, metres.
        camera_tilt: smallest and largest downward tilt of the camera, degrees; negative is upward.
        age: of the youngest and the oldest person, years.
        stature: of the smallest and the tallest person, metres.
        clip_length: number of successive frames with the same people; None is 10, or 90 in a
            video.
        rate: frames per second of smooth motion; None generates independent frames.
        crossing: whether people walk across the view, hide each other, and leave the image; a
            video only.
        cropped: whether the image edge can cut people off.
        background: whether people are in a room; its furniture does not hide them.
        furniture: whether people are in a room with much furniture, which can hide any part of
            them; a quarter of them sit on some of it.
        sloppy_masks: whether the masks of the frames are wrong by some pixels, like those of a
            segmenter.
        mocap: a folder of motion capture files (BVH) to sample poses or motion from.
        mocap_mapping: mapping file for their joints; None is the one for CMU.
        mocap_fraction: fraction of people who move as in `mocap`.
        mocap_only: use only these clips; names, or patterns such as 05_*; empty uses all.
        mocap_without: use none of these clips.
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
    crossing: bool = False
    cropped: bool = False
    background: bool = False
    furniture: bool = False
    sloppy_masks: bool = False
    mocap: Path | None = None
    mocap_mapping: Path | None = None
    mocap_fraction: float = 0.5
    mocap_only: tuple[str, ...] = ()
    mocap_without: tuple[str, ...] = ()


def sensor_of(settings: SyntheticSettings) -> Sensor:
    """Return the sensor with the changes that the settings make."""
    sensor = SENSORS[settings.sensor]
    changes = {
        name: getattr(settings, name)
        for name in ('width', 'height', 'field_of_view', 'noise')
        if getattr(settings, name) is not None
    }
    return sensor._replace(**changes)


def camera_of(settings: SyntheticSettings) -> Intrinsics:
    """Return the intrinsics: square pixels, principal point in the middle of the image."""
    sensor = sensor_of(settings)
    focal = 0.5 * sensor.width / np.tan(np.radians(0.5 * sensor.field_of_view))
    return Intrinsics(
        float(focal), float(focal), 0.5 * (sensor.width - 1), 0.5 * (sensor.height - 1)
    )


def clip_length_of(settings: SyntheticSettings) -> int:
    """Return the number of successive frames with the same people."""
    if settings.clip_length is not None:
        return settings.clip_length
    return CLIP_LENGTH if settings.rate is None else VIDEO_CLIP_LENGTH


def check(settings: SyntheticSettings) -> None:
    """Check settings.

    Raises:
        InputError: a value is out of range, or two settings contradict each other.
    """
    if settings.sensor not in SENSORS:
        msg = f'sensor is {settings.sensor}; give one of {", ".join(SENSORS)}'
        raise InputError(msg)
    for holds, complaint in (
        *_amount_conditions(settings),
        *_camera_conditions(settings),
        *_people_conditions(settings),
    ):
        if not holds:
            raise InputError(complaint)


_Condition = tuple[bool, str]


def _amount_conditions(settings: SyntheticSettings) -> tuple[_Condition, ...]:
    length, rate = clip_length_of(settings), settings.rate
    return (
        (settings.frames >= 1, f'frames is {settings.frames}; give 1 or more'),
        (settings.seed >= 0, f'seed is {settings.seed}; give 0 or more'),
        (length >= 1, f'the clip length is {length} frames; give 1 or more'),
        (
            rate is None or 1 <= rate <= 1000,
            f'the rate is {rate or 0:g} frames a second; give 1 to 1000',
        ),
        (
            rate is not None or not settings.crossing,
            'people cross only in a video; give its frame rate',
        ),
        (
            not (settings.crossing and settings.furniture),
            'people cross only in rooms without furniture; leave one of the two out',
        ),
    )


def _camera_conditions(settings: SyntheticSettings) -> tuple[_Condition, ...]:
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
            f'distance is {near:g} to {far:g} m; give the smaller first, both within 0.5 to 20',
        ),
        (
            0 <= lowest <= highest <= 5,
            (
                f'the camera height is {lowest:g} to {highest:g} m; give the smaller first, both '
                f'within 0 to 5'
            ),
        ),
        (
            -_MAX_TILT <= up <= down <= _MAX_TILT,
            (
                f'the camera tilt is {up:g} to {down:g} degrees; give the smaller first, both '
                f'within {-_MAX_TILT:g} (up) to {_MAX_TILT:g} (down)'
            ),
        ),
    )


def _people_conditions(settings: SyntheticSettings) -> tuple[_Condition, ...]:
    small, tall = settings.stature
    young, old = settings.age
    fewest = 0 if settings.furniture else 1
    return (
        (
            fewest <= settings.people <= MAX_PEOPLE,
            f'people is {settings.people}; give {fewest} to {MAX_PEOPLE}',
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
            0 <= settings.mocap_fraction <= 1,
            f'the fraction of motion capture is {settings.mocap_fraction:g}; give 0 to 1',
        ),
        (
            settings.mocap is not None or not settings.mocap_only + settings.mocap_without,
            'motion capture clips are named, but the folder is not given',
        ),
    )
