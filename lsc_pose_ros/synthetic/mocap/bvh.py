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

"""Reads BVH files (Biovision Hierarchy): a skeleton and the rotations of its joints in each frame.

After M. Meredith and S. Maddock, Motion Capture File Formats Explained, University of Sheffield,
2001. A joint's channels apply in the order of the file: R = R_1 R_2 R_3.
"""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.synthetic.geometry.rotations import axis_rotation

END = '_end'
"""Suffix of the names of end sites, which the file does not name: `hand` has `hand_end`."""

_AXES = 'XYZ'

# Larger numbers are damage.
_LARGEST = 1e9
_MOST_JOINTS = 1000

# Poses take 96 bytes each, but a joint without channels takes none in the frames of a file.
_MOST_POSES = 20_000_000

_CHANNELS = tuple(f'{axis}{kind}' for kind in ('position', 'rotation') for axis in _AXES)


class Bvh(NamedTuple):
    """A moving skeleton of J joints, end sites included, in T frames.

    Attributes:
        names: of the joints, parents before children.
        parents: the number of each joint's parent, -1 for the root.
        offsets: from the parent, in the parent's axes and the file's unit, shape (J, 3).
        channels: the channels of each joint in order, such as `Xrotation`; end sites have none.
        values: of all joints' channels, in degrees or the file's unit, shape (T, C).
        frame_time: seconds.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: NDArray[np.float64]
    channels: tuple[tuple[str, ...], ...]
    values: NDArray[np.float64]
    frame_time: float


def load_bvh(path: str | os.PathLike[str]) -> Bvh:
    """Return skeleton and motion of the file `path`.

    Raises:
        InputError: the file cannot be read or is not a valid BVH file; the message names the line.
    """
    try:
        text = Path(path).read_text(encoding='latin-1')  # names can be in any 8-bit code page
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror or error}'
        raise InputError(msg) from error
    reader = _LineReader(Path(path), text)
    joints = _read_hierarchy(reader)
    width = sum(len(joint.channels) for joint in joints)
    values, frame_time = _read_motion(reader, width)
    if len(values) * len(joints) > _MOST_POSES:
        reader.fail(f'{len(values)} frames of {len(joints)} joints are too many; split the file')
    return Bvh(
        tuple(joint.name for joint in joints),
        tuple(joint.parent for joint in joints),
        np.array([joint.offset for joint in joints]),
        tuple(joint.channels for joint in joints),
        values,
        frame_time,
    )


class JointPoses(NamedTuple):
    """Positions and orientations of J joints in T frames, in the file's axes.

    Attributes:
        orientations: of each joint, shape (T, J, 3, 3).
        positions: in the file's unit, shape (T, J, 3).
    """

    orientations: NDArray[np.float64]
    positions: NDArray[np.float64]


def joint_poses(bvh: Bvh) -> JointPoses:
    """Return the joints' poses: R_j = R_parent L_j, x_j = x_parent + R_parent (o_j + p_j)."""
    frames = len(bvh.values)
    orientations = np.empty((frames, len(bvh.names), 3, 3))
    positions = np.empty((frames, len(bvh.names), 3))
    first = 0
    for joint, (parent, channels) in enumerate(zip(bvh.parents, bvh.channels, strict=True)):
        columns = bvh.values[:, first : first + len(channels)]
        first += len(channels)
        local, shift = _local(channels, columns)
        shift += bvh.offsets[joint]
        if parent < 0:
            orientations[:, joint], positions[:, joint] = local, shift
            continue
        orientations[:, joint] = orientations[:, parent] @ local
        moved = np.einsum('tij,tj->ti', orientations[:, parent], shift)
        positions[:, joint] = positions[:, parent] + moved
    return JointPoses(orientations, positions)


def _local(
    channels: tuple[str, ...], columns: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return one joint's rotation relative to its parent, (T, 3, 3), and translation, (T, 3)."""
    rotation = np.tile(np.eye(3), (len(columns), 1, 1))
    shift = np.zeros((len(columns), 3))
    for channel, column in zip(channels, columns.T, strict=True):
        axis = _AXES.index(channel[0])
        if channel.endswith('position'):
            shift[:, axis] = column
        else:
            rotation = rotation @ axis_rotation(axis, np.radians(column))
    return rotation, shift


class _Joint(NamedTuple):
    name: str
    parent: int
    offset: list[float]
    channels: tuple[str, ...]


class _LineReader:
    """Reads the non-empty lines of a file, split into words."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._lines = iter(enumerate(text.splitlines(), start=1))
        self._number = 0

    def next(self, wanted: str) -> list[str]:
        """Return the words of the next line; `wanted` names what is missing at the end."""
        for number, line in self._lines:
            self._number = number
            words = line.split()
            if words:
                return words
        return self.fail(f'the file ends, but {wanted} is expected')

    def expect(self, *words: str) -> list[str]:
        """Return the rest of the next line, which must begin with `words`."""
        wanted = ' '.join(words)
        found = self.next(wanted)
        if found[: len(words)] != list(words):
            self.fail(f'{" ".join(found)[:40]!r} found, but {wanted} is expected')
        return found[len(words) :]

    def numbers(self, words: list[str], count: int) -> list[float]:
        """Return `words` as `count` finite numbers."""
        try:
            values = [float(word) for word in words]
        except ValueError as error:
            self.fail(excerpt(error))
        if len(values) != count:
            self.fail(f'{len(values)} numbers found, but {count} are expected')
        if not (np.abs(values) <= _LARGEST).all():  # NaN, too
            self.fail(f'a number is not finite, or beyond {_LARGEST:g}')
        return values

    def rest(self) -> Iterator[list[str]]:
        """Yield the words of each remaining line."""
        for number, line in self._lines:
            self._number = number
            words = line.split()
            if words:
                yield words

    def fail(self, why: str) -> NoReturn:
        """Raise an InputError that names the line."""
        msg = f'{self._path}, line {self._number}: {why}; give a valid BVH file'
        raise InputError(msg)


def _read_hierarchy(reader: _LineReader) -> list[_Joint]:
    reader.expect('HIERARCHY')
    joints = [_read_joint(reader, reader.expect('ROOT'), -1)]
    names = {joints[0].name}
    open_joints = [0]
    while open_joints:
        words = reader.next('}')
        if words == ['}']:
            open_joints.pop()
            continue
        parent = open_joints[-1]
        if words[0] == 'JOINT':
            joint = _read_joint(reader, words[1:], parent)
        elif words == ['End', 'Site']:
            joint = _read_end(reader, joints[parent].name, parent)
        else:
            reader.fail(f'{" ".join(words)[:40]!r} is not one of JOINT, End Site and }}')
        if joint.name in names:
            reader.fail(f'a second joint {excerpt(joint.name)}')
        if len(joints) == _MOST_JOINTS:
            reader.fail(f'more than {_MOST_JOINTS} joints')
        names.add(joint.name)
        if words[0] == 'JOINT':
            open_joints.append(len(joints))
        joints.append(joint)
    return joints


def _read_joint(reader: _LineReader, name: list[str], parent: int) -> _Joint:
    if not name:
        reader.fail('a joint has no name')
    reader.expect('{')
    offset = reader.numbers(reader.expect('OFFSET'), 3)
    count, *channels = reader.expect('CHANNELS') or ['']
    if count != str(len(channels)):
        reader.fail(
            f'{len(channels)} channels found, but {excerpt(count) or "their number"} is expected'
        )
    unknown = [channel for channel in channels if channel not in _CHANNELS]
    if unknown:
        reader.fail(f'unknown channel {excerpt(unknown[0])}')
    return _Joint(' '.join(name), parent, offset, tuple(channels))


def _read_end(reader: _LineReader, name: str, parent: int) -> _Joint:
    reader.expect('{')
    offset = reader.numbers(reader.expect('OFFSET'), 3)
    reader.expect('}')
    return _Joint(name + END, parent, offset, ())


def _read_motion(reader: _LineReader, width: int) -> tuple[NDArray[np.float64], float]:
    reader.expect('MOTION')
    frames = reader.numbers(reader.expect('Frames:'), 1)[0]
    frame_time = reader.numbers(reader.expect('Frame', 'Time:'), 1)[0]
    if frame_time <= 0:
        reader.fail(f'a frame lasts {frame_time:g} s')
    values = [reader.numbers(words, width) for words in reader.rest()]
    if len(values) != frames or not values:
        reader.fail(f'{len(values)} frames instead of {frames:g}')
    return np.array(values), frame_time
