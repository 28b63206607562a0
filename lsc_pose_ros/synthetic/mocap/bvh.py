"""Reads BVH files (Biovision Hierarchy): a skeleton, and its joints' rotations frame by frame.

After M. Meredith and S. Maddock, Motion Capture File Formats Explained, University of Sheffield,
2001. A joint's channels apply in the order in which the file names them: R = R_1 R_2 R_3.
"""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.motion.rotations import about

END = '_end'
"""Ends the name of an end site, which the file leaves unnamed: that of `hand` is `hand_end`."""

_AXES = 'XYZ'
_CHANNELS = tuple(f'{axis}{kind}' for kind in ('position', 'rotation') for axis in _AXES)


class Bvh(NamedTuple):
    """A moving skeleton of J joints, end sites among them, in T frames.

    Attributes:
        names: of the joints, parents before children.
        parents: the number of each joint's parent, -1 for the root.
        offsets: from the parent, in the parent's axes, in the file's unit, shape (J, 3).
        channels: what moves each joint, such as `Xrotation`, in order; end sites have none.
        values: of all joints' channels, degrees and the file's unit, shape (T, C).
        frame_time: seconds.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: NDArray[np.float64]
    channels: tuple[tuple[str, ...], ...]
    values: NDArray[np.float64]
    frame_time: float


def load_bvh(path: str | os.PathLike[str]) -> Bvh:
    """Return the skeleton and the motion in the file `path`.

    Raises:
        InputError: the file cannot be read, or is no sound BVH file; names the line.
    """
    try:
        text = Path(path).read_text(encoding='latin-1')  # names may be in any old code page
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror or error}'
        raise InputError(msg) from error
    lines = _Lines(Path(path), text)
    joints = _read_hierarchy(lines)
    width = sum(len(joint.channels) for joint in joints)
    values, frame_time = _read_motion(lines, width)
    return Bvh(
        tuple(joint.name for joint in joints),
        tuple(joint.parent for joint in joints),
        np.array([joint.offset for joint in joints]),
        tuple(joint.channels for joint in joints),
        values,
        frame_time,
    )


class Placed(NamedTuple):
    """Where J joints are in T frames, in the file's axes.

    Attributes:
        turns: how each joint is turned in space, shape (T, J, 3, 3).
        positions: in the file's unit, shape (T, J, 3).
    """

    turns: NDArray[np.float64]
    positions: NDArray[np.float64]


def place_joints(bvh: Bvh) -> Placed:
    """Return where the joints are: R_j = R_parent L_j, x_j = x_parent + R_parent (o_j + p_j)."""
    frames = len(bvh.values)
    turns = np.empty((frames, len(bvh.names), 3, 3))
    positions = np.empty((frames, len(bvh.names), 3))
    first = 0
    for joint, (parent, channels) in enumerate(zip(bvh.parents, bvh.channels, strict=True)):
        columns = bvh.values[:, first : first + len(channels)]
        first += len(channels)
        local, shift = _local(channels, columns)
        shift += bvh.offsets[joint]
        if parent < 0:
            turns[:, joint], positions[:, joint] = local, shift
            continue
        turns[:, joint] = turns[:, parent] @ local
        moved = np.einsum('tij,tj->ti', turns[:, parent], shift)
        positions[:, joint] = positions[:, parent] + moved
    return Placed(turns, positions)


def _local(
    channels: tuple[str, ...], columns: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return one joint's rotation against its parent, (T, 3, 3), and its own shift, (T, 3)."""
    rotation = np.tile(np.eye(3), (len(columns), 1, 1))
    shift = np.zeros((len(columns), 3))
    for channel, column in zip(channels, columns.T, strict=True):
        axis = _AXES.index(channel[0])
        if channel.endswith('position'):
            shift[:, axis] = column
        else:
            rotation = rotation @ about(axis, np.radians(column))
    return rotation, shift


class _Joint(NamedTuple):
    name: str
    parent: int
    offset: list[float]
    channels: tuple[str, ...]


class _Lines:
    """A file's lines that are not empty, split into words, one after the other."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._lines = iter(enumerate(text.splitlines(), start=1))
        self._number = 0

    def next(self, wanted: str) -> list[str]:
        """Return the next line's words; `wanted` tells the user what is missing at the end."""
        for number, line in self._lines:
            self._number = number
            words = line.split()
            if words:
                return words
        return self.fail(f'the file ends where {wanted} should be')

    def expect(self, *words: str) -> list[str]:
        """Return what the next line says after `words`, with which it must begin."""
        wanted = ' '.join(words)
        found = self.next(wanted)
        if found[: len(words)] != list(words):
            self.fail(f'{" ".join(found)[:40]!r} stands where {wanted} should be')
        return found[len(words) :]

    def numbers(self, words: list[str], count: int) -> list[float]:
        """Return `words` as `count` finite numbers."""
        try:
            values = [float(word) for word in words]
        except ValueError as error:
            self.fail(str(error))
        if len(values) != count:
            self.fail(f'{len(values)} numbers stand where {count} should be')
        if not np.isfinite(values).all():
            self.fail('a number is not finite')
        return values

    def rest(self) -> Iterator[list[str]]:
        """Return the words of each remaining line."""
        for number, line in self._lines:
            self._number = number
            words = line.split()
            if words:
                yield words

    def fail(self, why: str) -> NoReturn:
        """Say what is wrong and in which line."""
        msg = f'{self._path}, line {self._number}: {why}; give a sound BVH file'
        raise InputError(msg)


def _read_hierarchy(lines: _Lines) -> list[_Joint]:
    lines.expect('HIERARCHY')
    joints = [_read_joint(lines, lines.expect('ROOT'), -1)]
    open_joints = [0]
    while open_joints:
        words = lines.next('}')
        if words == ['}']:
            open_joints.pop()
            continue
        parent = open_joints[-1]
        if words[0] == 'JOINT':
            joint = _read_joint(lines, words[1:], parent)
        elif words == ['End', 'Site']:
            joint = _read_end(lines, joints[parent].name, parent)
        else:
            lines.fail(f'{" ".join(words)[:40]!r} is none of JOINT, End Site and }}')
        if any(joint.name == other.name for other in joints):
            lines.fail(f'a second joint {joint.name}')
        if words[0] == 'JOINT':
            open_joints.append(len(joints))
        joints.append(joint)
    return joints


def _read_joint(lines: _Lines, name: list[str], parent: int) -> _Joint:
    if not name:
        lines.fail('a joint has no name')
    lines.expect('{')
    offset = lines.numbers(lines.expect('OFFSET'), 3)
    count, *channels = lines.expect('CHANNELS') or ['']
    if count != str(len(channels)):
        lines.fail(f'{len(channels)} channels stand where {count or "their number"} should be')
    unknown = [channel for channel in channels if channel not in _CHANNELS]
    if unknown:
        lines.fail(f'unknown channel {unknown[0]}')
    return _Joint(' '.join(name), parent, offset, tuple(channels))


def _read_end(lines: _Lines, name: str, parent: int) -> _Joint:
    lines.expect('{')
    offset = lines.numbers(lines.expect('OFFSET'), 3)
    lines.expect('}')
    return _Joint(name + END, parent, offset, ())


def _read_motion(lines: _Lines, width: int) -> tuple[NDArray[np.float64], float]:
    lines.expect('MOTION')
    frames = lines.numbers(lines.expect('Frames:'), 1)[0]
    frame_time = lines.numbers(lines.expect('Frame', 'Time:'), 1)[0]
    if frame_time <= 0:
        lines.fail(f'a frame lasts {frame_time:g} s')
    values = [lines.numbers(words, width) for words in lines.rest()]
    if len(values) != frames or not values:
        lines.fail(f'{len(values)} frames instead of {frames:g}')
    return np.array(values), frame_time
