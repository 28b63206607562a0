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

"""Imports ITOP (Haque, Peng, Luo, Alahi, Yeung, Fei-Fei, ECCV 2016): one person, side view.

A set is two HDF5 files, NAME_depth_map.h5 and NAME_labels.h5. Depth is in metres; positions have y
up; only frames that the authors call valid have labels. The mask is where a body part is labelled.
The images have no stamps: their numbers in `id` give them, at 30 Hz.
"""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.datasets.image_folder import EPOCH, FRAME_ID
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.tracks import skeletons_of
from lsc_pose_ros.labels.vocabulary import Vocabulary, load_vocabulary

BODY = 1
FRAME_RATE = 30
_SECOND = 1_000_000_000

# x = (column - 160) z 0.0035, y = (120 - row) z 0.0035, as the authors convert pixels to points.
CAMERA = Intrinsics(1 / 0.0035, 1 / 0.0035, 160.0, 120.0)

# A person's frames are numbered to this at most; the next person begins later.
_MOST_FRAMES = 100_000

_SUFFIX = '_depth_map.h5'


def import_itop(depth_map: Path, stride: int) -> Iterator[Frame]:
    """Yield the valid frames of a set.

    Args:
        depth_map: the file NAME_depth_map.h5; NAME_labels.h5 is beside it.
        stride: yield every stride-th valid frame.

    Raises:
        InputError: h5py is not installed, or a file is missing or of another form.
    """
    if not depth_map.name.endswith(_SUFFIX):
        msg = f'{depth_map} is not a file NAME{_SUFFIX} of ITOP; NAME_labels.h5 must be beside it'
        raise InputError(msg)
    labels_path = depth_map.with_name(depth_map.name.removesuffix(_SUFFIX) + '_labels.h5')
    with _open(depth_map) as depth, _open(labels_path) as labels:
        images = _array(depth_map, depth, 'data')
        valid = np.flatnonzero(_array(labels_path, labels, 'is_valid')[:])
        names = _array(labels_path, labels, 'id')[:]
        positions = _array(labels_path, labels, 'real_world_coordinates')
        parts = _array(labels_path, labels, 'segmentation')
        if not len(images) == len(names) == len(positions) == len(parts):
            msg = (
                f'{depth_map} and {labels_path} have different numbers of frames; fetch them again'
            )
            raise InputError(msg)
        for index in valid[::stride].tolist():
            shown = np.asarray(parts[index])
            yield Frame(
                _stamp(names[index]),
                FRAME_ID,
                np.nan_to_num(np.asarray(images[index], np.float32)),
                np.where(shown >= 0, BODY, NO_BODY).astype(np.int32),
                CAMERA,
                skeletons_of({BODY: _ours(np.asarray(positions[index], np.float64))}),
            )


def _ours(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    return _vocabulary().ours(positions * (1.0, -1.0, 1.0))


@cache
def _vocabulary() -> Vocabulary:
    return load_vocabulary('itop')


def _stamp(name: bytes | str) -> int:
    """Return the stamp of a frame that is called PERSON_NUMBER, nanoseconds."""
    text = name.decode() if isinstance(name, bytes) else str(name)
    person, _, number = text.partition('_')
    if not (person.isdecimal() and number.isdecimal()):
        msg = f'{text!r:.40} is not the id of a frame of ITOP, such as 00_00012'
        raise InputError(msg)
    return EPOCH + (int(person) * _MOST_FRAMES + int(number)) * _SECOND // FRAME_RATE


def _open(path: Path) -> Any:  # noqa: ANN401 - h5py has no types
    try:
        import h5py  # noqa: PLC0415 - an optional dependency
    except ImportError:
        msg = 'reading ITOP needs the package h5py; install it with pip install h5py'
        raise InputError(msg) from None
    try:
        return h5py.File(path, 'r')
    except OSError as error:
        msg = f'{path} cannot be read as an HDF5 file ({error}); both files of a set are needed'
        raise InputError(msg) from error


def _array(path: Path, file: Any, name: str) -> Any:  # noqa: ANN401
    if name not in file:
        msg = f'{path} has no array {name}; it is not a file of ITOP'
        raise InputError(msg)
    return file[name]
