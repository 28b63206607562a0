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

"""Finds and reads the .mat files of UTD-MHAD without corrections, which `utd_mhad` applies."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError

LAG = 2
"""Number of frames that the skeletons are ahead of the depth images."""

FRAME_RATE = 30
SECOND = 1_000_000_000

# The data set has no time stamps. Recordings start at this time (2015-01-01), so that each import
# gives the same file.
_EPOCH = 1_420_070_400 * SECOND
_GAP = SECOND  # between sequences, so that they are not taken for one motion

_DEPTH_NAME = re.compile(r'a(\d+)_s(\d+)_t(\d+)_depth\.mat')
_JOINT_COUNT = 20


class Selection(NamedTuple):
    """The frames to import.

    Attributes:
        subjects: numbers of the subjects, or None for all.
        actions: numbers of the actions, or None for all.
        trials: numbers of the trials, or None for all.
        stride: import every stride-th frame of a sequence.
        max_frames: sample this number of frames, evenly from all selected ones; None takes all.
        seed: of the sampling.
    """

    subjects: Sequence[int] | None = None
    actions: Sequence[int] | None = None
    trials: Sequence[int] | None = None
    stride: int = 1
    max_frames: int | None = None
    seed: int = 0


class ActionSequence(NamedTuple):
    """One sequence of the data set with the depth images to import.

    Attributes:
        depth_path: the file with the depth images.
        skeletons: joints in the data set's order and axes, metres, shape (20, 3, T).
        start: the stamp of depth image 0, nanoseconds.
        frames: numbers of the depth images to import, ascending, shape (n,).
    """

    depth_path: Path
    skeletons: NDArray[np.float64]
    start: int
    frames: NDArray[np.int64]


def select_sequences(directory: Path, selection: Selection) -> list[ActionSequence]:
    """Find the frames of `selection`, sorted by subject, action, trial and time.

    Args:
        directory: the folder that contains the folders Depth and Skeleton.
        selection: the frames.

    Returns:
        The sequences that have frames to import.

    Raises:
        InputError: the folder is not UTD-MHAD, nothing matches, or a skeleton file is unreadable.
    """
    _check_selection(selection)
    sequences: list[ActionSequence] = []
    start = _EPOCH
    for path in _matching_paths(directory, selection):
        skeletons = _read_skeletons(_skeleton_path(path))
        length = skeletons.shape[2]
        frames = np.arange(LAG, length, selection.stride)
        sequences.append(ActionSequence(path, skeletons, start, frames))
        start += length * SECOND // FRAME_RATE + _GAP
    if not any(len(sequence.frames) for sequence in sequences):
        msg = f'no sequence selected in {directory} is longer than {LAG} frames; select more'
        raise InputError(msg)
    if selection.max_frames is not None:
        sequences = _sample(sequences, selection.max_frames, selection.seed)
    return [sequence for sequence in sequences if len(sequence.frames)]


def _check_selection(selection: Selection) -> None:
    if selection.stride < 1:
        msg = f'the stride is {selection.stride}; give 1 or more'
        raise InputError(msg)
    if selection.max_frames is not None and selection.max_frames < 1:
        msg = f'the maximum number of frames is {selection.max_frames}; give 1 or more'
        raise InputError(msg)
    if selection.seed < 0:
        msg = f'the seed is {selection.seed}; give 0 or more'
        raise InputError(msg)


def _matching_paths(directory: Path, selection: Selection) -> list[Path]:
    _check_folders(directory)
    found: dict[tuple[int, ...], Path] = {}
    for path in (directory / 'Depth').iterdir():
        if match := _DEPTH_NAME.fullmatch(path.name):
            action, subject, trial = (int(group) for group in match.groups())
            found[subject, action, trial] = path
    if not found:
        msg = f'{directory / "Depth"} has no file aA_sS_tT_depth.mat; give the folder of UTD-MHAD'
        raise InputError(msg)
    wanted = (selection.subjects, selection.actions, selection.trials)
    for index, (kind, numbers) in enumerate(
        zip(('subject', 'action', 'trial'), wanted, strict=True)
    ):
        available = {key[index] for key in found}
        missing = sorted(set(numbers or ()) - available)
        if missing:
            msg = (
                f'{directory} has no sequence of {kind} {missing[0]}; '
                f'it has {", ".join(str(number) for number in sorted(available))}'
            )
            raise InputError(msg)
    paths = [found[key] for key in sorted(found) if _matches(key, wanted)]
    if not paths:
        msg = f'no sequence in {directory} has this subject, action and trial; select more'
        raise InputError(msg)
    return paths


def _check_folders(directory: Path) -> None:
    advice = 'give the folder of UTD-MHAD that contains the folders Depth and Skeleton'
    if not directory.is_dir():
        msg = f'there is no folder {directory}; {advice}'
        raise InputError(msg)
    missing = [name for name in ('Depth', 'Skeleton') if not (directory / name).is_dir()]
    if missing:
        msg = f'{directory} has no folder {" and no folder ".join(missing)}; {advice}'
        raise InputError(msg)


def _matches(key: tuple[int, ...], wanted: tuple[Sequence[int] | None, ...]) -> bool:
    pairs = zip(key, wanted, strict=True)
    return all(numbers is None or number in numbers for number, numbers in pairs)


def _skeleton_path(depth_path: Path) -> Path:
    name = depth_path.name.replace('_depth', '_skeleton')
    return depth_path.parent.parent / 'Skeleton' / name


def _sample(sequences: Sequence[ActionSequence], count: int, seed: int) -> list[ActionSequence]:
    """Keep `count` frames: a random one from each of `count` equal parts of all frames."""
    lengths = np.array([len(sequence.frames) for sequence in sequences])
    total = int(lengths.sum())
    if total <= count:
        return list(sequences)
    edges = np.arange(count + 1) * total // count
    random = np.random.Generator(np.random.PCG64(seed))
    chosen = edges[:-1] + np.floor(random.random(count) * np.diff(edges)).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(lengths)])
    return [
        sequence._replace(frames=sequence.frames[chosen[(chosen >= low) & (chosen < high)] - low])
        for sequence, low, high in zip(sequences, first[:-1], first[1:], strict=True)
    ]


def _read_skeletons(path: Path) -> NDArray[np.float64]:
    skeletons = _load(path, 'd_skel').astype(np.float64)
    if skeletons.ndim != 3 or skeletons.shape[:2] != (_JOINT_COUNT, 3):
        msg = f'd_skel in {path} has the shape {skeletons.shape}, not (20, 3, T); fetch it again'
        raise InputError(msg)
    return skeletons


def read_depth(sequence: ActionSequence) -> NDArray[np.uint16]:
    """Return all depth images of a sequence as stored, millimetres, shape (H, W, T).

    Raises:
        InputError: the file is unreadable or does not fit its skeletons.
    """
    depth = _load(sequence.depth_path, 'd_depth')
    length = sequence.skeletons.shape[2]
    if depth.ndim != 3 or depth.shape[2] != length:
        msg = (
            f'd_depth in {sequence.depth_path} has the shape {depth.shape}, '
            f'but its skeleton file has {length} frames; fetch both again'
        )
        raise InputError(msg)
    return depth.astype(np.uint16)


def _load(path: Path, key: str) -> NDArray[Any]:
    """Return the array `key` of a .mat file."""
    try:
        from scipy.io import loadmat  # noqa: PLC0415 - an optional dependency
    except ImportError:
        msg = (
            'reading UTD-MHAD needs scipy; install it with pip install scipy, or as python3-scipy'
        )
        raise InputError(msg) from None
    if not path.is_file():
        msg = f'{path} is missing; every depth file needs its skeleton file beside it'
        raise InputError(msg)
    try:
        contents = loadmat(path, variable_names=[key])
    except Exception as error:  # a damaged file raises exceptions of many types
        msg = f'{path} cannot be read as a .mat file ({error}); fetch it again'
        raise InputError(msg) from error
    if key not in contents:
        msg = f'{path} has no array {key}; it is not a file of UTD-MHAD'
        raise InputError(msg)
    return np.asarray(contents[key])
