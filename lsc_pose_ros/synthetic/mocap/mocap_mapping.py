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

"""Mapping from the joints of motion capture files to the segments of a person: a YAML file."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.resources.yaml_tables import read_yaml, table_of

TRUNK: tuple[str, ...] = ('pelvis', 'waist', 'chest', 'neck', 'head')
ARM: tuple[str, ...] = ('shoulder', 'upper_arm', 'forearm', 'hand')
LEG: tuple[str, ...] = ('thigh', 'shank', 'foot')
SEGMENTS: tuple[str, ...] = TRUNK + tuple(
    f'{side}_{name}' for side in ('l', 'r') for name in ARM + LEG
)
"""The segments of a person in motion capture; `l_` is the person's own left."""

_LINE_SEGMENTS = ('upper_arm', 'forearm', 'thigh', 'shank')  # their direction is captured
_OPTIONAL = ('waist', 'neck', 'head', 'shoulder', 'hand', 'foot')
_AXES = {'x': 0, 'y': 1, 'z': 2}


class SegmentSource(NamedTuple):
    """The joints that determine the orientation of one segment.

    Attributes:
        turns: the joint that the segment rotates with; '' if it follows a line.
        along: the joints at the beginning and the end of that line.
        across: two joints; the line between them points ahead if the arm hangs straight, palm
            inwards: from the little finger to the index finger. If empty, the orientation of the
            first joint of `along` is used.
        at_rest: rotation of the segment in the neutral pose relative to the standing pose, degrees
            about the person's x, y and z, shape (3,).
        bent: flexion of elbow or knee in reality when the neutral pose was captured, degrees; None
            uses the joints in the file.
    """

    turns: str = ''
    along: tuple[str, ...] = ()
    across: tuple[str, ...] = ()
    at_rest: tuple[float, ...] = (0.0, 0.0, 0.0)
    bent: float | None = None

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that are named."""
        return tuple(name for name in (self.turns, *self.along, *self.across) if name)


class MocapMapping(NamedTuple):
    """Mapping from the files of one hierarchy to the segments of a person.

    Attributes:
        path: of the mapping file.
        axes: the person's left, up and forward in the neutral pose, as rows in the file's axes,
            shape (3, 3).
        neutral: the number of the frame in which the person stands upright and looks ahead, soles
            level; None if all rotations are 0 in the neutral pose.
        skip: number of frames at the beginning of each file that are not part of the motion.
        segments: the source of each segment.
    """

    path: Path
    axes: NDArray[np.float64]
    neutral: int | None
    skip: int
    segments: Mapping[str, SegmentSource]

    @property
    def joints(self) -> tuple[str, ...]:
        """All joints that are named."""
        return tuple(name for source in self.segments.values() for name in source.joints)


def load_mapping(path: str | os.PathLike[str]) -> MocapMapping:
    """Return the mapping of the YAML file `path`.

    Raises:
        InputError: the file cannot be read or is not a valid mapping.
    """
    target = Path(path)
    loaded = read_yaml(target, 'mapping')
    try:
        return _read(
            target, table_of(loaded, 'a mapping', ('axes', 'neutral', 'skip', 'segments'))
        )
    except ValueError as error:
        msg = f'{target} is not a usable mapping: {error}'
        raise InputError(msg) from error


def _read(path: Path, loaded: dict[str, Any]) -> MocapMapping:
    segments = {
        name: _source(name, value)
        for name, value in table_of(loaded.get('segments'), 'segments', SEGMENTS).items()
    }
    needed = [
        name for name in SEGMENTS if name.removeprefix('l_').removeprefix('r_') not in _OPTIONAL
    ]
    missing = [name for name in needed if name not in segments]
    if missing:
        msg = f'segments has no {", ".join(missing)}'
        raise ValueError(msg)
    neutral = loaded.get('neutral')
    return MocapMapping(
        path,
        _axes(loaded.get('axes', {'up': 'y', 'forward': 'z'})),
        None if neutral is None else _count('neutral', neutral),
        _count('skip', loaded.get('skip', 0)),
        segments,
    )


def _axes(value: Any) -> NDArray[np.float64]:  # noqa: ANN401 - anything that YAML holds
    named = table_of(value, 'axes', ('up', 'forward'))
    up, forward = (_axis(named.get(name), name) for name in ('up', 'forward'))
    if abs(up @ forward) > 0:
        msg = 'axes: up and forward lie along the same axis'
        raise ValueError(msg)
    return np.stack([np.cross(up, forward), up, forward])


def _axis(value: Any, name: str) -> NDArray[np.float64]:  # noqa: ANN401
    letter = str(value).lower().lstrip('+-')
    if letter not in _AXES or len(str(value)) > 2:
        msg = f'axes: {name} is {excerpt(repr(value))}; give x, y, z, -x, -y or -z'
        raise ValueError(msg)
    axis = np.zeros(3)
    axis[_AXES[letter]] = -1.0 if str(value).startswith('-') else 1.0
    return axis


def _source(name: str, value: Any) -> SegmentSource:  # noqa: ANN401
    named = table_of(value, name, SegmentSource._fields)
    source = SegmentSource(
        _joint(name, named.get('turns', '')),
        _joints(name, 'along', named.get('along')),
        _joints(name, 'across', named.get('across')),
        _degrees(name, named.get('at_rest', (0, 0, 0))),
        _bent(name, named.get('bent')),
    )
    if bool(source.turns) == bool(source.along):
        msg = f'{name} needs either turns: JOINT or along: [FROM, TO]'
        raise ValueError(msg)
    if _part(name) in _LINE_SEGMENTS and not source.along:
        msg = f'{name} needs along: [FROM, TO], the joints at its two ends'
        raise ValueError(msg)
    if _part(name) not in (*_LINE_SEGMENTS, 'hand') and not source.turns:
        msg = f'{name} needs turns: JOINT, the joint that it rotates with'
        raise ValueError(msg)
    return source


def _part(segment: str) -> str:
    """Return the segment's name without its side."""
    return segment.removeprefix('l_').removeprefix('r_')


def _joint(name: str, value: Any) -> str:  # noqa: ANN401
    if not isinstance(value, str | int):
        msg = f'{name}: {excerpt(repr(value))} is not the name of a joint'
        raise ValueError(msg)  # noqa: TRY004
    return str(value)


def _joints(name: str, key: str, value: Any) -> tuple[str, ...]:  # noqa: ANN401
    if value is None:
        return ()
    if not isinstance(value, list) or len(value) != 2:
        msg = f'{name}: {key} must be two joints, [FROM, TO]'
        raise ValueError(msg)
    return tuple(_joint(name, joint) for joint in value)


def _degrees(name: str, value: Any) -> tuple[float, ...]:  # noqa: ANN401
    try:
        numbers = tuple(float(number) for number in value)
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        msg = f'{name}: at_rest must be three numbers, degrees about x, y and z'
        raise ValueError(msg)
    return numbers


def _bent(name: str, value: Any) -> float | None:  # noqa: ANN401
    if value is None:
        return None
    if _part(name) not in ('forearm', 'shank'):
        msg = f'{name}: bent is only allowed in forearm and shank'
        raise ValueError(msg)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 90:
        msg = f'{name}: bent is {excerpt(repr(value))}; give 0 to 90 degrees'
        raise ValueError(msg)
    return float(value)


def _count(name: str, value: Any) -> int:  # noqa: ANN401
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        msg = f'{name} is {excerpt(repr(value))}; give a frame number, 0 or more'
        raise ValueError(msg)
    return value
