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


"""Files of the forests of body parts: an archive of numpy arrays, without anything executable."""

import json
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.context import PLANES, PartForests
from lsc_pose_ros.body_parts.part_forest import BEYOND, CLASSES, PartForest
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.model_io.forest_packing import Form
from lsc_pose_ros.model_io.model_file import check_sizes, read_array
from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.resources.package_files import resource

FORMAT = 'lsc_pose_ros body parts'
VERSION = 2

PART_FORESTS = archive('a forest of body parts', 'header.npy', FORMAT.encode())

MOST_TREES = 16
"""A forest with more trees would take too long."""

MOST_SPLITS = 64
"""The largest number of splits on the way from a root to a leaf."""

_ARRAYS: dict[str, Form] = {
    'roots': (np.int32, 1),
    'splits': (np.float32, 2),
    'plane': (np.uint8, 1),
    'left': (np.int32, 1),
    'leaves': (np.uint8, 2),
}


class PartForestFile(NamedTuple):
    """The content of a file.

    Attributes:
        forests: the forests.
        provenance: information for users, by name.
    """

    forests: PartForests
    provenance: dict[str, str]


def save_part_forests(
    path: str | os.PathLike[str], forests: PartForests, provenance: dict[str, str]
) -> None:
    """Write forests to `path`.

    Raises:
        InputError: the file cannot be written, or another kind of file is there.
    """
    header = {
        'format': FORMAT,
        'version': VERSION,
        'classes': ['no person', *JOINT_NAMES],
        'provenance': provenance,
    }
    arrays: dict[str, Any] = {'header': np.frombuffer(json.dumps(header).encode(), np.uint8)}
    for which, forest in forests._asdict().items():
        for name, value in forest._asdict().items():
            arrays[f'{which}_{name}'] = np.asarray(value, _ARRAYS[name][0])
    write_output(Path(path), PART_FORESTS, lambda file: np.savez_compressed(file, **arrays))


def load_part_forests(path: str | os.PathLike[str] | None = None) -> PartForestFile:
    """Return the forests in a file, or those of the package.

    Args:
        path: the path of a file; None for those that come with the package.

    Raises:
        InputError: there is no such file, it is no body-part forest, it has another version, or
            its parts do not fit together.
    """
    source = resource('body_parts', 'body_parts.npz') if path is None else Path(path)
    try:
        check_sizes(source)
        with np.load(source, allow_pickle=False) as archive:
            provenance = _read_header(archive)
            forests = PartForests(*(_read_forest(archive, name) for name in PartForests._fields))
    except FileNotFoundError as error:
        msg = f'there is no file {source}'
        raise InputError(msg) from error
    except Exception as error:  # a damaged file makes numpy raise errors of many types
        raise _unusable(source, error) from error
    try:
        check_part_forest(forests.first, 1)
        check_part_forest(forests.second, PLANES)
    except UnusableModelError as error:
        raise _unusable(source, error) from error
    return PartForestFile(forests, provenance)


def _read_forest(archive: Any, which: str) -> PartForest:  # noqa: ANN401
    arrays = {name: read_array(archive, f'{which}_{name}', form) for name, form in _ARRAYS.items()}
    return PartForest(**arrays)  # type: ignore[arg-type]


def _unusable(source: Path, error: Exception) -> InputError:
    why = str(error) or type(error).__name__
    return InputError(f'{source} is not a usable body-part forest ({why:.200})')


def _read_header(archive: Any) -> dict[str, str]:  # noqa: ANN401
    header = json.loads(read_array(archive, 'header', (np.uint8, 1)).tobytes())
    if not isinstance(header, dict) or header.get('format') != FORMAT:
        msg = 'its header is of another kind of file'
        raise UnusableModelError(msg)
    if header.get('version') != VERSION:
        msg = f'it has version {header.get("version")!r:.20}; this package reads {VERSION}'
        raise UnusableModelError(msg)
    if header.get('classes') != ['no person', *JOINT_NAMES]:
        msg = 'its classes are not those of this package'
        raise UnusableModelError(msg)
    provenance = header.get('provenance')
    if not isinstance(provenance, dict):
        msg = 'its provenance is no table'
        raise UnusableModelError(msg)
    return {str(name): str(value) for name, value in provenance.items()}


def check_part_forest(forest: PartForest, planes: int) -> None:
    """Check every number that a kernel uses, because kernels check none.

    Args:
        forest: the forest.
        planes: the number of planes that it may compare.

    Raises:
        UnusableModelError: the parts of the forest do not fit together.
    """
    nodes, leaves = len(forest.left), len(forest.leaves)
    fit = forest.splits.shape == (nodes, 5) and forest.plane.shape == (nodes,)
    if not fit or forest.leaves.shape[1:] != (CLASSES,) or not leaves:
        msg = 'its parts have shapes that do not fit together'
        raise UnusableModelError(msg)
    roots = forest.roots
    if not 1 <= len(roots) <= MOST_TREES or roots.min() < 0 or roots.max() >= nodes:
        msg = f'its trees are not 1 to {MOST_TREES}, or begin outside of its nodes'
        raise UnusableModelError(msg)
    # Written so that NaN is not good. No depth and no offset is larger than BEYOND.
    if not (np.abs(forest.splits) <= float(BEYOND)).all():
        msg = f'a split is not within {float(BEYOND):g} m'
        raise UnusableModelError(msg)
    if forest.plane.max() >= planes:
        msg = f'a split compares a plane that does not exist; there are {planes}'
        raise UnusableModelError(msg)
    _check_children(forest.left, leaves)


def _check_children(left: NDArray[np.int32], leaves: int) -> None:
    """Check that every path ends in one of the leaves after at most MOST_SPLITS splits."""
    split = left >= 0
    number = np.arange(len(left))
    if (left[~split] < -leaves).any():
        msg = 'a leaf does not exist'
        raise UnusableModelError(msg)
    if (left[split] <= number[split]).any() or (left[split] >= len(left) - 1).any():
        msg = 'a node does not come before its children'
        raise UnusableModelError(msg)
    level = np.zeros(len(left), np.int64)
    for _ in range(MOST_SPLITS + 1):
        below = level[split] + 1
        deeper = level.copy()
        np.maximum.at(deeper, left[split], below)
        np.maximum.at(deeper, left[split] + 1, below)
        if (deeper == level).all():
            return
        level = deeper
    msg = f'a leaf is below more than {MOST_SPLITS} splits'
    raise UnusableModelError(msg)
