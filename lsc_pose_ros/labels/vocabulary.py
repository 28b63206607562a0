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

"""Joint vocabularies: which joints of another program are which of ours, as YAML files."""

import os
from collections.abc import Mapping
from functools import reduce
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.body_frame import body_frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.resources.yaml_tables import read_yaml, table_of

OWN = 'lsc_pose'
"""The vocabulary of our own joint names."""

_KEYS = ('names', 'joints_per_body', 'joints')
_SOURCE_KEYS = ('of', 'offset')
_MOST_JOINTS = 1000
_LARGEST_NUMBER = 1e6
_ALL_JOINTS = np.arange(len(JOINT_NAMES), dtype=np.uint16)


class JointSource(NamedTuple):
    """What one of our joints is made of.

    Attributes:
        weights: the weight of each of the other program's joints.
        offset: added to their weighted mean, metres forward, left and up in the axes of the body,
            so that the joint lies where it does in our anatomy.
    """

    weights: Mapping[str, float]
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Vocabulary(NamedTuple):
    """The joints of another program.

    Attributes:
        path: the file.
        names: the S joints of the other program, in the order of their numbers.
        joints_per_body: markers are numbered body * joints_per_body + joint; 0: the namespace of a
            marker is the joint's name, and its number is the body's.
        joints: what each of our joints is made of.
    """

    path: Path
    names: tuple[str, ...]
    joints_per_body: int
    joints: Mapping[str, JointSource]

    def number_of(self, word: str) -> int | None:
        """Return the index in `names` of a joint that is named or numbered; None if unknown."""
        if word in self.names:
            return self.names.index(word)
        numbered = word.isascii() and word.isdecimal() and len(word) <= len(str(len(self.names)))
        return int(word) if numbered and int(word) < len(self.names) else None

    @property
    def listed(self) -> str:
        """The names of the joints for a message."""
        return excerpt(', '.join(self.names), 500)

    def ours(self, positions: NDArray[np.floating]) -> NDArray[np.float64]:
        """Return our joints without their offsets, shape (..., 20, 3).

        Args:
            positions: the other program's joints, shape (..., S, 3), NaN if unknown.

        Returns:
            Weighted means, NaN if one of their joints is unknown.
        """
        ours = np.full((*positions.shape[:-2], len(JOINT_NAMES), 3), np.nan)
        for name, source in self.joints.items():
            parts = [
                weight * positions[..., self.names.index(each), :].astype(np.float64)
                for each, weight in source.weights.items()
            ]
            ours[..., JOINT_NUMBERS[name], :] = reduce(np.add, parts)
        return ours

    def with_offsets(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the joints of one body, shape (20, 3), moved to where they are in our anatomy.

        A joint that has an offset becomes NaN if the axes of the body are unknown.
        """
        offsets = np.zeros_like(positions)
        for name, source in self.joints.items():
            offsets[JOINT_NUMBERS[name]] = source.offset
        moved = np.asarray(offsets.any(axis=1))
        if not moved.any():
            return positions
        frame = body_frame(_ALL_JOINTS, positions.astype(np.float32))
        if frame is None:
            return np.where(moved[:, None], np.nan, positions)
        return positions + offsets @ frame.axes.T


def vocabularies() -> list[str]:
    """Return the names of the vocabularies that come with the package."""
    folder = resource('config', 'joints')
    return sorted(path.stem for path in folder.glob('*.yaml'))


def load_vocabulary(name: str | os.PathLike[str]) -> Vocabulary:
    """Return a vocabulary of the package by its name, or that of a YAML file.

    Raises:
        InputError: there is no such vocabulary or file, or it is not valid.
    """
    path = Path(name)
    if not path.suffix:
        known = vocabularies()
        if str(name) not in known:
            msg = (
                f'no joint vocabulary {name} comes with the package; it has {", ".join(known)}; '
                'give one of them or the path of a .yaml file'
            )
            raise InputError(msg)
        path = resource('config', 'joints', f'{name}.yaml')
    try:
        return _read(path, read_yaml(path, 'joint vocabulary'))
    except ValueError as error:
        msg = f'{path} is not a usable joint vocabulary: {error}'
        raise InputError(msg) from error


def _read(path: Path, loaded: object) -> Vocabulary:
    table = table_of(loaded, 'the file', _KEYS)
    joints = {
        name: _joint(name, value)
        for name, value in table_of(table.get('joints'), 'joints', JOINT_NAMES).items()
    }
    if not joints:
        msg = 'joints is empty'
        raise ValueError(msg)
    used = list(dict.fromkeys(each for source in joints.values() for each in source.weights))
    names = table.get('names', used)
    if not isinstance(names, list) or not all(isinstance(each, str | int) for each in names):
        msg = 'names must be a list of names'
        raise ValueError(msg)
    if len({str(each) for each in names}) < len(names) or len(names) > _MOST_JOINTS:
        msg = f'names must be at most {_MOST_JOINTS} different names'
        raise ValueError(msg)
    missing = [each for each in used if each not in [str(name) for name in names]]
    if missing:
        msg = f'joints uses {excerpt(missing[0])}, which is not among names'
        raise ValueError(msg)
    per_body = table.get('joints_per_body', 0)
    if type(per_body) is not int or not 0 <= per_body <= _LARGEST_NUMBER:
        given = excerpt(repr(per_body))
        msg = f'joints_per_body is {given}, not a number from 0 to {_LARGEST_NUMBER:.0f}'
        raise ValueError(msg)
    return Vocabulary(path, tuple(str(name) for name in names), per_body, joints)


def _joint(name: str, value: Any) -> JointSource:  # noqa: ANN401
    offset: Any = (0.0, 0.0, 0.0)
    if isinstance(value, dict) and 'of' in value:
        table = table_of(value, name, _SOURCE_KEYS)
        value, offset = table['of'], table.get('offset', offset)
    if isinstance(value, str | int):
        value = [value]
    if isinstance(value, list) and value:
        value = dict.fromkeys(map(_source, value), 1 / len(value))
    if not isinstance(value, dict) or not value:
        msg = f'{name} must be a joint, a list of joints, or weights of joints'
        raise ValueError(msg)
    weights = {_source(each): _number(weight, name) for each, weight in value.items()}
    if abs(sum(weights.values()) - 1) > 1e-6:
        msg = f'the weights of {name} sum to {sum(weights.values()):g}, not to 1'
        raise ValueError(msg)
    if not isinstance(offset, list | tuple) or len(offset) != 3:
        msg = f'the offset of {name} must be three numbers: metres forward, left and up'
        raise ValueError(msg)
    x, y, z = (_number(each, name) for each in offset)
    return JointSource(weights, (x, y, z))


def _number(value: object, name: str) -> float:
    if not isinstance(value, int | float) or not abs(value) <= _LARGEST_NUMBER:
        msg = f'{name}: {excerpt(repr(value))} is not a number'
        raise ValueError(msg)
    return float(value)


def _source(value: object) -> str:
    if not isinstance(value, str | int):
        msg = f'{excerpt(repr(value))} is not the name of a joint'
        raise ValueError(msg)  # noqa: TRY004 - the user's error, not the program's
    return str(value)
