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

"""Model files: a zip archive of numpy arrays and a JSON header, without anything executable.

The file is what `numpy.savez_compressed` writes, read with `allow_pickle=False`.
`forest_packing.py` describes the arrays of the forest, and `model_header.py` the header.
"""

import math
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.model_io.forest_packing import ARRAYS as FOREST_ARRAYS
from lsc_pose_ros.model_io.forest_packing import Form, pack_forest, unpack_forest
from lsc_pose_ros.model_io.model_check import check_model
from lsc_pose_ros.model_io.model_header import FORMAT, Header, decode_header, encode_header
from lsc_pose_ros.model_io.unusable_model import UnusableModelError, why_unusable
from lsc_pose_ros.pose.inference.confidence import uncalibrated
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.resources.package_files import find_model, shipped_models

MODEL = archive('a model', 'header.npy', FORMAT.encode())

# The largest models are some tens of megabytes; more than this is a zip bomb.
LARGEST_ARRAY = 1 << 30
# Those of models are two or three times as large as the file; a bomb is a thousand times.
LARGEST_RATIO = 100
SMALL = 1 << 20
MOST_PARTS = 100

_ARRAYS: dict[str, Form] = {
    'joints': (np.uint16, 1),
    'edges': (np.int32, 2),
    'limb_lengths': (np.float32, 1),
    **FOREST_ARRAYS,
}
# Missing in models whose confidence is not calibrated.
_CALIBRATION = 'calibration'
_CALIBRATION_FORM: Form = (np.float32, 2)


def save_model(path: str | os.PathLike[str], model: Model) -> int:
    """Write `model` to `path`; return the size of the file, bytes.

    An interrupted write leaves an older model there as it was.

    Raises:
        InputError: the file cannot be written, or another kind of file is there.
    """
    arrays: dict[str, Any] = {
        'header': encode_header(model),
        'joints': model.joints,
        'edges': model.edges,
        'limb_lengths': model.limb_lengths,
        **({_CALIBRATION: model.calibration} if len(model.calibration) else {}),
        **pack_forest(model.forest),
    }
    return write_output(Path(path), MODEL, lambda file: np.savez_compressed(file, **arrays))


def load_model(model: str | os.PathLike[str]) -> Model:
    """Return the model in a file, or a model that comes with the package.

    Args:
        model: the path of a model file, or the name of a model of the package: 'default' or
            'front'. A file takes precedence over a model of the package with the same name.

    Raises:
        InputError: there is no such file or name, the file is no model, it has another version,
            or its parts do not fit together.
    """
    if not isinstance(model, (str, os.PathLike)):
        msg = (
            f'model is of type {type(model).__name__}, but must be a path or the name of a model '
            f'of the package: {", ".join(shipped_models())}'
        )
        raise InputError(msg)
    source = find_model(os.fspath(model))
    try:
        check_sizes(source)
        with np.load(source, allow_pickle=False) as archive:
            header = _read_header(archive)
            calibration = {_CALIBRATION: _CALIBRATION_FORM} if _CALIBRATION in archive else {}
            arrays = {
                name: read_array(archive, name, form)
                for name, form in (_ARRAYS | calibration).items()
            }
        return _assemble(header, arrays)
    except FileNotFoundError as error:
        msg = f'there is no model file {source}; make one with `lsc_pose train`'
        raise InputError(msg) from error
    except Exception as error:  # a damaged file makes numpy raise errors of many types
        why = why_unusable(error)
        msg = f'{source} is not a usable model file ({why}); make one with `lsc_pose train`'
        raise InputError(msg) from error


def describe_model(model: Model) -> dict[str, str]:
    """Return the properties of a model by name, as text for users, in a fixed order."""
    forest = model.forest
    leaves = len(forest.joint_votes.start) - 1
    return {
        'joints': ', '.join(names_of(model.joints)),
        'trees': str(len(forest.roots)),
        'nodes': str(len(forest.feature)),
        'leaves': str(leaves),
        'joint votes': str(len(forest.joint_votes.target)),
        'pair votes': str(len(forest.pair_votes.target)),
        'confidence': 'calibrated' if len(model.calibration) else 'the fraction of the votes',
        **{
            name.replace('_', ' '): f'{value:g}' if isinstance(value, float) else str(value)
            for name, value in model.settings._asdict().items()
        },
        **model.provenance,
    }


def check_sizes(path: Path, most_parts: int = MOST_PARTS) -> None:
    """Check the sizes that an archive claims, before memory is allocated for its arrays.

    Args:
        path: the archive.
        most_parts: the most arrays that an archive of its kind may have.

    Raises:
        UnusableModelError: a part is too large to be that of a model, or is much larger than the
            file, or is shorter than its array.
    """
    most = LARGEST_RATIO * path.stat().st_size + SMALL
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
        for entry in entries:
            if entry.file_size > min(LARGEST_ARRAY, most):
                msg = f'its part {entry.filename!r:.40} has {entry.file_size} bytes'
                raise UnusableModelError(msg)
        if len(entries) > most_parts or sum(entry.file_size for entry in entries) > most:
            msg = 'its parts are too many, or far larger than the file'
            raise UnusableModelError(msg)
        for entry in entries:
            _check_part(archive, entry)


def _check_part(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> None:
    """Check that a part has the bytes of the array that it claims to be."""
    with archive.open(entry) as stream:
        version = np.lib.format.read_magic(stream)
        read = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, _, kind = read(stream)
    if kind.hasobject or math.prod(shape) * kind.itemsize > entry.file_size:
        msg = f'its part {entry.filename!r:.40} is shorter than its array'
        raise UnusableModelError(msg)


def _read_header(archive: Any) -> Header:  # noqa: ANN401
    if 'header' not in archive:
        msg = 'it has no header'
        raise UnusableModelError(msg)
    return decode_header(archive['header'])


def read_array(archive: Any, name: str, form: Form) -> NDArray[np.generic]:  # noqa: ANN401
    """Return an array of an archive.

    Raises:
        UnusableModelError: the array is missing or has another form.
    """
    if name not in archive:
        msg = f'its part {name} is missing'
        raise UnusableModelError(msg)
    array, (kind, dimensions) = archive[name], form
    if array.dtype != np.dtype(kind) or array.ndim != dimensions:
        msg = f'its part {name} is {array.dtype} with {array.ndim} dimensions'
        raise UnusableModelError(msg)
    return np.ascontiguousarray(array)


def _assemble(header: Header, arrays: dict[str, Any]) -> Model:
    model = Model(
        arrays['joints'],
        arrays['edges'],
        arrays['limb_lengths'],
        header.settings,
        unpack_forest(arrays),
        header.provenance,
        arrays.get(_CALIBRATION, uncalibrated()),
    )
    check_model(model)
    return model
