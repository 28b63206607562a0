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

"""The files of MSR-Action3D: depth sequences, and skeletons in metres and in pixels.

A sequence NAME, for example a01_s02_e03 (action, subject, trial), is three files:

    NAME_sdepth.bin      three int32: frames, columns, rows; then the depth of all pixels, int32,
                         row by row, 0 where there is no person. Their unit is not published.
    NAME_skeleton3D.txt  20 lines per frame: x, y, z in metres, confidence
    NAME_skeleton.txt    20 lines per frame: column and row in the image, depth, confidence
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError

JOINTS = 20

_DEPTH = '_sdepth.bin'
_POSITIONS = '_skeleton3D.txt'
_PIXELS = '_skeleton.txt'
_NAME = re.compile(r'a(\d+)_s(\d+)_e(\d+)')
_HEADER = np.dtype('<i4')
_LARGEST_SIDE = 10_000


class MsrSequence(NamedTuple):
    """A sequence of F frames.

    Attributes:
        action: the number of the action, from 1.
        depth: the file of the depth images.
        positions: metres, x, y up and z forward, NaN if unknown, shape (F, 20, 3).
        pixels: column and row in the image, NaN if unknown, shape (F, 20, 2).
    """

    action: int
    depth: Path
    positions: NDArray[np.float64]
    pixels: NDArray[np.float64]


def find_msr_sequences(folder: Path) -> list[MsrSequence]:
    """Return the sequences below a folder that have all three files, sorted by name.

    Raises:
        InputError: there are none, or a file is not of its form.
    """
    found = {
        suffix: {path.name.removesuffix(suffix): path for path in folder.rglob(f'*{suffix}')}
        for suffix in (_DEPTH, _POSITIONS, _PIXELS)
    }
    names = [name for name in sorted(set.intersection(*map(set, found.values()))) if _action(name)]
    if not names:
        counts = ', '.join(f'{len(paths)} files *{suffix}' for suffix, paths in found.items())
        msg = (
            f'{folder} has no sequence of MSR-Action3D with all three files ({counts}); unpack '
            'Depth, MSRAction3DSkeletonReal3D and MSRAction3DSkeleton(20joints) below it'
        )
        raise InputError(msg)
    return [
        MsrSequence(
            _action(name),
            found[_DEPTH][name],
            *_skeletons(found[_POSITIONS][name], found[_PIXELS][name]),
        )
        for name in names
    ]


def read_msr_depth(path: Path) -> NDArray[np.int32]:
    """Return the depth images of a file in its own unit, shape (F, H, W).

    Raises:
        InputError: it cannot be read, or has another size than its header says.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror or error}'
        raise InputError(msg) from error
    header = np.frombuffer(data[: 3 * _HEADER.itemsize], _HEADER).tolist()
    if len(header) < 3 or min(header) < 1 or max(header[1:]) > _LARGEST_SIDE:
        msg = f'{path} has not the header of a depth sequence of MSR-Action3D'
        raise InputError(msg)
    frames, columns, rows = header
    values = len(data) // _HEADER.itemsize - 3
    if len(data) % _HEADER.itemsize or values != frames * columns * rows:
        msg = (
            f'{path} has {len(data)} bytes, but {frames} images of {columns} x {rows} pixels need '
            f'{(3 + frames * columns * rows) * _HEADER.itemsize}; fetch it again'
        )
        raise InputError(msg)
    pixels = np.frombuffer(data, _HEADER, offset=3 * _HEADER.itemsize)
    return pixels.reshape(frames, rows, columns).astype(np.int32)


def _action(name: str) -> int:
    """Return the number of the action of a sequence, or 0 if it is not the name of one."""
    found = _NAME.fullmatch(name)
    return int(found[1]) if found else 0


def _skeletons(positions: Path, pixels: Path) -> Sequence[NDArray[np.float64]]:
    """Return positions and pixels of all frames; both are NaN where a joint is not known."""
    metres, image = _read_table(positions), _read_table(pixels)
    if len(metres) != len(image):
        msg = f'{positions} has {len(metres)} frames and {pixels} {len(image)}; fetch both again'
        raise InputError(msg)
    unknown = ~(metres[..., 2] > 0)
    places = image[..., :2]
    metres[unknown] = places[unknown] = np.nan
    return metres[..., :3], places


def _read_table(path: Path) -> NDArray[np.float64]:
    """Return the numbers of a skeleton file, shape (F, 20, 4)."""
    try:
        table = np.loadtxt(path, np.float64, ndmin=2)
    except (OSError, ValueError) as error:
        msg = f'cannot read the skeletons of {path}: {error}'
        raise InputError(msg) from error
    if table.shape[1] != 4 or len(table) % JOINTS:
        msg = (
            f'{path} has {len(table)} lines of {table.shape[1]} numbers; a skeleton of '
            f'MSR-Action3D is {JOINTS} lines of 4'
        )
        raise InputError(msg)
    return table.reshape(-1, JOINTS, 4)
