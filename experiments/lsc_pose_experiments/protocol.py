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

"""Which frames are learnt from and which are tested."""

import zlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from lsc_pose_experiments.drawn_frames import Draw, DrawnFrame, draw_frames, merge
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError

PROTOCOLS = ('random', 'recordings', 'leave-one-out')
"""The paper's: frames of all recordings, at random; others: other recordings are tested."""

# The paper tests 900 of 4,500 frames.
_TEST_SHARE = 5


class Study(NamedTuple):
    """What is measured on.

    Attributes:
        recordings: to learn from, and of two protocols also to test with.
        tests: to test with, of the protocol `recordings`.
        protocol: one of PROTOCOLS.
        test_frames: how many frames are tested at most, in each fold.
        seed: of the draws.
        topics: all that decides what the frames of a recording are, for the keys of results.
    """

    recordings: tuple[Path, ...]
    tests: tuple[Path, ...] = ()
    protocol: str = 'random'
    test_frames: int = 900
    seed: int = 0
    topics: tuple[str, ...] = ()


class Fold(NamedTuple):
    """One way to divide recordings: which are learnt from, which are tested.

    In the protocol `random` both are all, and their frames are divided.
    """

    train: tuple[Path, ...]
    test: tuple[Path, ...]


class FoldFrames(NamedTuple):
    """The frames of a fold: those to learn from, in the order of their turns, and the tested."""

    train: list[DrawnFrame]
    test: list[DrawnFrame]


def folds_of(study: Study) -> list[Fold]:
    """Return the ways in which the recordings are divided.

    Raises:
        InputError: the protocol needs other recordings.
    """
    recordings, tests = study.recordings, study.tests
    if bool(tests) != (study.protocol == 'recordings'):
        msg = f'the protocol {study.protocol} ' + (
            'takes no --test: it divides the --recordings'
            if tests
            else 'needs --test: the recordings to test with'
        )
        raise InputError(msg)
    if study.protocol == 'recordings':
        return [Fold(recordings, tests)]
    if study.protocol == 'random':
        return [Fold(recordings, recordings)]
    if len(recordings) < 2:
        msg = 'the protocol leave-one-out needs two --recordings or more, best one a person'
        raise InputError(msg)
    return [Fold((*recordings[:n], *recordings[n + 1 :]), (recordings[n],))
            for n in range(len(recordings))]  # fmt: skip


def fold_key(study: Study, fold: Fold) -> dict[str, object]:
    """Return all that decides which frames a fold has, but for how many are learnt from."""
    return {
        'protocol': study.protocol,
        'train': [_identity(path) for path in fold.train],
        'test': [_identity(path) for path in fold.test],
        'test_frames': study.test_frames,
        'seed': study.seed,
        'topics': list(study.topics),
    }


def _identity(path: Path) -> list[object]:
    """Return what tells a recording from others, and from itself once it has changed."""
    files = sorted(path.rglob('*')) if path.is_dir() else [path]
    return [path.name, *([file.stat().st_size, file.stat().st_mtime_ns] for file in files)]


class Draws:
    """What is drawn from the recordings of a study, each read once, when it is first needed."""

    def __init__(self, study: Study, wanted: int, read: Callable[[Path], Iterable[Frame]]) -> None:
        """Draw frames for folds that learn from `wanted` frames; `read` opens a recording."""
        self._study = study
        self._wanted = wanted + study.test_frames
        self._read = read
        self._draws: dict[Path, Draw] = {}

    def frames(self, fold: Fold) -> FoldFrames:
        """Return the frames of `fold`.

        Raises:
            InputError: there are too few, or a recording cannot be read.
        """
        if self._study.protocol == 'random':
            frames = self._divide([self._of(path) for path in fold.train])
        else:
            test = merge(self._of(path) for path in fold.test)
            train = merge(self._of(path) for path in fold.train)
            frames = FoldFrames(train, test[: self._study.test_frames])
        if not frames.train or not frames.test:
            names = _names(fold.test if frames.train else fold.train)
            msg = f'{names}: too few labelled frames to learn from some and test others'
            raise InputError(msg)
        return frames

    def _divide(self, draws: list[Draw]) -> FoldFrames:
        frames = merge(draws)
        tested = min(self._study.test_frames, sum(draw.labelled for draw in draws) // _TEST_SHARE)
        return FoldFrames(frames[tested:], frames[:tested])

    def _of(self, path: Path) -> Draw:
        if path not in self._draws:
            # By the name, so that what is drawn does not depend on the other recordings.
            seed = self._study.seed, zlib.crc32(path.name.encode())
            self._draws[path] = draw_frames(self._read(path), self._wanted, seed)
        return self._draws[path]


def _names(paths: Sequence[Path]) -> str:
    return ', '.join(str(path) for path in paths)
