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

import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.lock_beside import locked
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.files.output_place import check_output, is_written_through
from lsc_pose_ros.files.sibling_names import sibling
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

_MOST_PARTS = 1 + MOST_TREES * (len(_NODES) + len(_KINDS) * len(_VOTES))
"""The arrays of a checkpoint with as many trees as a model may have, and its header."""


def checkpoint_path(model: Path) -> Path:
    """Return where the training of the file `model` keeps its finished trees.

    It is one place for all names of the file.
    """
    return sibling(Path(os.path.realpath(model)), '.checkpoint')


def _tell_nobody(_text: str) -> None:
    pass


class CheckpointFile:
    """Keeps the finished trees of a training in a file; a Checkpoint.

    As a context manager, it keeps other trainings away from the file.

    Args:
        path: the file. A link stays; a device or a pipe is written to, and keeps nothing.
        program: name and version of the program, for another one may grow other trees.
        resume: whether the trees that the file has are used.
        tell: gets a sentence for users about what happens to the trees.
        warn: gets a sentence for users who should know that something is wrong.
    """

    def __init__(
        self,
        path: Path,
        program: str,
        *,
        resume: bool,
        tell: Callable[[str], None] = _tell_nobody,
        warn: Callable[[str], None] = _tell_nobody,
    ) -> None:
        """Touch no file yet."""
        self._path = path
        self._program = program
        self._resume = resume
        self._tell = tell
        self._warn = warn
        self._opened = ExitStack()
        self._has_warned = False
        self._has_more = False

    def __enter__(self) -> 'CheckpointFile':  # noqa: PYI034 - typing.Self is of Python 3.11
        """Lock the file, and check it against `resume`.

        Raises:
            InputError: another training has the file, or it has trees that would be lost.
        """
        busy = (
            f'{self._path} is in use by another training with the same output; '
            'wait for its end, or choose another name for the model'
        )
        with ExitStack() as stack:
            if not is_written_through(self._path):
                stack.enter_context(locked(self._path, busy))
            self._check_resume()
            self._opened = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        """Release the lock."""
        self._opened.close()

    def load(self, key: str, limits: Limits, wanted: int) -> list[FinishedTree]:
        """Return the trees in the file, at most `wanted`; none if there is no file.

        Raises:
            InputError: the file is damaged, or belongs to another training.
        """
        if not self._resume or not self._path.is_file():
            return []
        try:
            found, trees = _read(self._path, limits, {'key': key, 'program': self._program})
        except Exception as error:  # a damaged file makes numpy raise errors of many types
            why = why_unusable(error)
            msg = (
                f'{self._path} is not a usable checkpoint ({why}); remove it to begin anew, '
                'without --resume'
            )
            raise InputError(msg) from error
        if not found:
            msg = (
                f'{self._path} belongs to a training with other recordings or settings, or of '
                'another version; give the same ones, or remove it to begin anew, without --resume'
            )
            raise InputError(msg)
        self._has_more = len(trees) > wanted
        taken = trees[:wanted]
        self._tell(f'{len(taken)} of {wanted} trees are taken from {self._path}')
        return taken

    def store(self, key: str, trees: Sequence[FinishedTree]) -> None:
        """Write the trees to the file; an interrupted write leaves it as it was.

        If it cannot be written, a warning is given once, and the next tree tries again.
        """
        header = {'key': key, 'program': self._program, 'trees': len(trees)}
        arrays: dict[str, Any] = {'header': header_array(FORMAT, VERSION, header)}
        for number, tree in enumerate(trees):
            arrays |= {f'{number}_{name}': getattr(tree, name) for name in _NODES}
            for kind in _KINDS:
                votes: LeafVotes = getattr(tree, kind)
                arrays |= {f'{number}_{kind}_{name}': getattr(votes, name) for name in _VOTES}
        try:
            write_output(self._path, CHECKPOINT, lambda file: np.savez(file, **arrays))
        except (InputError, OSError) as error:
            if not self._has_warned:
                self._warn(f'the finished trees are not kept: {error}; the training goes on')
            self._has_warned = True

    def remove(self) -> None:
        """Remove the file when the model is written.

        It stays if it has more trees than the model, or is something else by now.
        """
        if self._has_more:
            self._tell(f'{self._path} stays: it has more trees than the model')
            return
        try:
            check_output(self._path, CHECKPOINT)
        except InputError:
            self._warn(f'{self._path} stays: it is no checkpoint')
            return
        # The target of a link is removed; the link stays, as where a file is written.
        target = Path(os.path.realpath(self._path))
        try:
            if target.is_file():
                target.unlink()
        except OSError as error:
            self._warn(f'{self._path} cannot be removed: {error.strerror}; it is not needed')

    def _check_resume(self) -> None:
        exists = self._path.is_file()
        if exists and not self._resume:
            msg = (
                f'{self._path} has the trees of a training that was interrupted; go on with '
                f'--resume, or remove {self._path} to begin anew'
            )
            raise InputError(msg)
        if self._resume and not exists:
            self._warn(f'--resume: there is no checkpoint {self._path}; the training begins anew')


def _read(path: Path, limits: Limits, expected: dict[str, str]) -> tuple[bool, list[FinishedTree]]:
    """Return whether the file has what is expected in its header, and its trees if it has."""
    check_sizes(path, _MOST_PARTS)
    with np.load(path, allow_pickle=False) as stored:
        header = read_header(stored, FORMAT, VERSION)
        count = header.get('trees')
        if not isinstance(count, int) or not 0 < count <= MOST_TREES:
            msg = f'it has {count!r:.20} trees'
            raise UnusableModelError(msg)
        # The trees of another training may have indices that are out of the limits of this one.
        if any(header.get(name) != value for name, value in expected.items()):
            return False, []
        return True, [_read_tree(stored, number, limits) for number in range(count)]


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
