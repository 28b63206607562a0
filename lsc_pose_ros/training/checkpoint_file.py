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

"""Checkpoint files: the trees that a training has finished, beside the model that it will write.

The file is what `numpy.savez` writes, read with `allow_pickle=False`, with a JSON header.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.model_io.archive_header import header_array, read_header
from lsc_pose_ros.model_io.forest_packing import Form
from lsc_pose_ros.model_io.model_check import MOST_TREES, check_forest
from lsc_pose_ros.model_io.model_file import check_sizes, read_array
from lsc_pose_ros.model_io.unusable_model import UnusableModelError, why_unusable
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.training.checkpoint import FinishedTree, Limits

FORMAT = 'lsc_pose checkpoint'
VERSION = 1

CHECKPOINT = archive('a checkpoint', 'header.npy', FORMAT.encode())

_NODES: dict[str, Form] = {
    'feature': (np.int16, 1),
    'threshold': (np.uint8, 1),
    'left': (np.int32, 1),
}
_VOTES: dict[str, Form] = {
    'start': (np.int32, 1),
    'target': (np.uint8, 1),
    'offset': (np.float32, 2),
    'weight': (np.float32, 1),
}
_KINDS = ('joint_votes', 'pair_votes')


def checkpoint_path(model: Path) -> Path:
    """Return where the training of the file `model` keeps its finished trees."""
    return model.with_name(f'{model.name}.checkpoint')


class CheckpointFile:
    """Keeps the finished trees of a training in a file; a Checkpoint.

    Args:
        path: the file.
        program: name and version of the program, for another one may grow other trees.
        resume: whether the trees that the file has are used.
    """

    def __init__(self, path: Path, program: str, *, resume: bool) -> None:
        """Touch no file yet."""
        self._path = path
        self._program = program
        self._resume = resume

    def load(self, key: str, limits: Limits) -> list[FinishedTree]:
        """Return the trees in the file; none if there is no file.

        Raises:
            InputError: the file is damaged, or belongs to another training.
        """
        if not self._resume or not self._path.exists():
            return []
        try:
            found, trees = _read(self._path, limits)
        except Exception as error:  # a damaged file makes numpy raise errors of many types
            why = why_unusable(error)
            msg = f'{self._path} is not a usable checkpoint ({why}); train without --resume'
            raise InputError(msg) from error
        if found != {'key': key, 'program': self._program}:
            msg = (
                f'{self._path} belongs to a training with other recordings or settings, or of '
                'another version; give the same ones, or train without --resume'
            )
            raise InputError(msg)
        return trees

    def store(self, key: str, trees: Sequence[FinishedTree]) -> None:
        """Write the trees to the file; an interrupted write leaves it as it was.

        Raises:
            InputError: the file cannot be written, or another kind of file is there.
        """
        header = {'key': key, 'program': self._program, 'trees': len(trees)}
        arrays: dict[str, Any] = {'header': header_array(FORMAT, VERSION, header)}
        for number, tree in enumerate(trees):
            arrays |= {f'{number}_{name}': getattr(tree, name) for name in _NODES}
            for kind in _KINDS:
                votes: LeafVotes = getattr(tree, kind)
                arrays |= {f'{number}_{kind}_{name}': getattr(votes, name) for name in _VOTES}
        write_output(self._path, CHECKPOINT, lambda file: np.savez(file, **arrays))

    def remove(self) -> None:
        """Remove the file, if it is there."""
        self._path.unlink(missing_ok=True)


def _read(path: Path, limits: Limits) -> tuple[dict[str, str], list[FinishedTree]]:
    check_sizes(path)
    with np.load(path, allow_pickle=False) as stored:
        header = read_header(stored, FORMAT, VERSION)
        count = header.get('trees')
        if not isinstance(count, int) or not 0 < count <= MOST_TREES:
            msg = f'it has {count!r:.20} trees'
            raise UnusableModelError(msg)
        trees = [_read_tree(stored, number, limits) for number in range(count)]
    return {name: str(header.get(name)) for name in ('key', 'program')}, trees


def _read_tree(stored: Any, number: int, limits: Limits) -> FinishedTree:  # noqa: ANN401
    nodes: list[Any] = [read_array(stored, f'{number}_{name}', _NODES[name]) for name in _NODES]
    votes = [_read_votes(stored, f'{number}_{kind}') for kind in _KINDS]
    tree = FinishedTree._make([*nodes, *votes])
    forest = Forest(np.zeros(1, np.int32), *tree)
    check_forest(forest, limits.features, limits.joints, limits.edges)
    return tree


def _read_votes(stored: Any, prefix: str) -> LeafVotes:  # noqa: ANN401
    votes: list[Any] = [read_array(stored, f'{prefix}_{name}', _VOTES[name]) for name in _VOTES]
    return LeafVotes._make(votes)
