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

"""Divides recordings into training and test frames."""

import zlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from lsc_pose_experiments.sampled_frames import FrameSample, SampledFrame, merge, sample_frames
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError

PROTOCOLS = ('random', 'recordings', 'leave-one-out')
"""`random` divides frames at random, as the paper; the others test other recordings."""

# The paper tests 900 of 4,500 frames.
_TEST_DIVISOR = 5


class DataSelection(NamedTuple):
    """The recordings of the measurements, and how they are divided.

    Attributes:
        recordings: training recordings; except with the protocol `recordings`, also tested.
        tests: test recordings of the protocol `recordings`.
        protocol: one of PROTOCOLS.
        test_frames: the largest number of test frames in each fold.
        seed: seed of the samples of frames.
        topics: the options that determine the frames of a recording, for the keys of results.
    """

    recordings: tuple[Path, ...]
    tests: tuple[Path, ...] = ()
    protocol: str = 'random'
    test_frames: int = 900
    seed: int = 0
    topics: tuple[str, ...] = ()


class Fold(NamedTuple):
    """One division into training and test recordings.

    With the protocol `random` both are all recordings, and their frames are divided.
    """

    train: tuple[Path, ...]
    test: tuple[Path, ...]


class FoldFrames(NamedTuple):
    """The training frames, ascending by rank, and the test frames of a fold."""

    train: list[SampledFrame]
    test: list[SampledFrame]


def folds_of(selection: DataSelection) -> list[Fold]:
    """Return the folds of the protocol.

    Raises:
        InputError: the recordings do not fit the protocol.
    """
    recordings, tests = selection.recordings, selection.tests
    if bool(tests) != (selection.protocol == 'recordings'):
        msg = f'the protocol {selection.protocol} ' + (
            'takes no --test: it divides the --recordings'
            if tests
            else 'needs --test: the recordings to test with'
        )
        raise InputError(msg)
    if selection.protocol == 'recordings':
        return [Fold(recordings, tests)]
    if selection.protocol == 'random':
        return [Fold(recordings, recordings)]
    if len(recordings) < 2:
        msg = 'the protocol leave-one-out needs two --recordings or more, best one a person'
        raise InputError(msg)
    return [Fold((*recordings[:n], *recordings[n + 1 :]), (recordings[n],))
            for n in range(len(recordings))]  # fmt: skip


def fold_key(selection: DataSelection, fold: Fold) -> dict[str, object]:
    """Return everything that determines the frames of a fold except their number in training."""
    return {
        'protocol': selection.protocol,
        'train': [_identity(path) for path in fold.train],
        'test': [_identity(path) for path in fold.test],
        'test_frames': selection.test_frames,
        'seed': selection.seed,
        'topics': list(selection.topics),
    }


def _identity(path: Path) -> list[object]:
    """Return values that identify a recording and its version."""
    files = sorted(path.rglob('*')) if path.is_dir() else [path]
    return [path.name, *([file.stat().st_size, file.stat().st_mtime_ns] for file in files)]


class FrameSampler:
    """Samples the frames of recordings; each is read once, when it is first needed."""

    def __init__(
        self, selection: DataSelection, wanted: int, read: Callable[[Path], Iterable[Frame]]
    ) -> None:
        """Prepare folds with `wanted` training frames; `read` yields the frames of a recording."""
        self._selection = selection
        self._wanted = wanted + selection.test_frames
        self._read = read
        self._draws: dict[Path, FrameSample] = {}

    def frames(self, fold: Fold) -> FoldFrames:
        """Return the frames of `fold`.

        Raises:
            InputError: there are too few labelled frames, or a recording cannot be read.
        """
        if self._selection.protocol == 'random':
            frames = self._divide([self._of(path) for path in fold.train])
        else:
            test = merge(self._of(path) for path in fold.test)
            train = merge(self._of(path) for path in fold.train)
            frames = FoldFrames(train, test[: self._selection.test_frames])
        if not frames.train or not frames.test:
            names = _names(fold.test if frames.train else fold.train)
            msg = f'{names}: too few labelled frames for training and test'
            raise InputError(msg)
        return frames

    def _divide(self, draws: list[FrameSample]) -> FoldFrames:
        frames = merge(draws)
        tested = min(
            self._selection.test_frames, sum(draw.labelled for draw in draws) // _TEST_DIVISOR
        )
        return FoldFrames(frames[tested:], frames[:tested])

    def _of(self, path: Path) -> FrameSample:
        if path not in self._draws:
            # The name is in the seed, so that a sample does not depend on the other recordings.
            seed = self._selection.seed, zlib.crc32(path.name.encode())
            self._draws[path] = sample_frames(self._read(path), self._wanted, seed)
        return self._draws[path]


def _names(paths: Sequence[Path]) -> str:
    return ', '.join(str(path) for path in paths)
