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

"""Trials: what is trained and tested, the results, and a folder that stores them."""

import base64
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.rivals import RIVALS, RivalSettings
from lsc_pose_ros.data_types.joints import names_of, numbers_of
from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation import evaluate
from lsc_pose_ros.evaluation.evaluate import Evaluation, summarise
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.numerics.source_hash import source_hash
from lsc_pose_ros.training import train
from lsc_pose_ros.training.train import TrainingSettings
from lsc_pose_ros.viz.drawing.canvas import make_directory

# To be incremented if the contents of a result, or the sampling of frames, change.
_FORMAT = 2

# The modules that, with those they use, determine the result of a trial.
_PROGRAM = (train, evaluate)


class Trial(NamedTuple):
    """One model, tested with one set of settings.

    Attributes:
        training: settings of the training; a joint that is never labelled is left out.
        frames: the largest number of training frames.
        graph: whether the pictorial structure is used.
        rival: settings of a rival with an estimator of its own, which uses of `training` only the
            joints and the seed. None for the method of the paper.
    """

    training: TrainingSettings
    frames: int
    graph: bool = True
    rival: RivalSettings | None = None


class TrialResult(NamedTuple):
    """The errors of P labelled people.

    Attributes:
        joints: joint numbers, shape (J,).
        errors: metres, NaN without ground truth, infinity without estimate, shape (P, J).
        sizes: size of each person relative to the mean of the fold, shape (P,).
        frames: number of training frames; the mean over several folds.
        seconds: duration of the training; the sum over several folds.
        frame_ms: median duration of the estimation of a frame, milliseconds; the mean over several
            folds. None if unknown.
    """

    joints: NDArray[np.uint16]
    errors: NDArray[np.float32]
    sizes: NDArray[np.float32]
    frames: int
    seconds: float
    frame_ms: float | None = None


class Accuracy(NamedTuple):
    """Mean error, metres, and fraction within the tolerance; None if unknown."""

    error: float | None = None
    fraction: float | None = None


def accuracy_of(result: TrialResult, tolerance: float) -> Accuracy:
    """Return mean error and mAP of `result`, as `evaluate` defines them; `tolerance` in metres."""
    labelled = result.errors[~np.isnan(result.errors)]
    if len(labelled) and np.isinf(labelled).all():
        return Accuracy(None, 0.0)
    summary = summarise(_evaluation(result), tolerance)
    return Accuracy(summary.mean_error_m, summary.map)


def _evaluation(result: TrialResult) -> Evaluation:
    people = len(result.errors)
    return Evaluation(
        result.joints,
        result.errors,
        np.arange(people),
        np.zeros(people, np.uint16),
        np.zeros(people),
        np.zeros_like(result.errors),
        np.full((*result.errors.shape, 3), np.nan, np.float32),
        np.full(result.errors.shape, UNKNOWN, np.uint8),
    )


def join_results(results: Sequence[TrialResult]) -> TrialResult:
    """Return the results of all folds as one."""
    joints = np.unique(np.concatenate([result.joints for result in results]))
    people = [np.full((len(result.errors), len(joints)), np.nan, np.float32) for result in results]
    for errors, result in zip(people, results, strict=True):
        errors[:, np.isin(joints, result.joints)] = result.errors
    return TrialResult(
        joints,
        np.concatenate(people),
        np.concatenate([result.sizes for result in results]),
        round(sum(result.frames for result in results) / len(results)),
        sum(result.seconds for result in results),
        _mean([result.frame_ms for result in results]),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if len(known) == len(values) else None


def trial_key(fold: dict[str, object], trial: Trial) -> dict[str, object]:
    """Return everything that determines the result of `trial` in a fold, with the source code."""
    modules = _PROGRAM if trial.rival is None else _PROGRAM + RIVALS[type(trial.rival)].program
    return {
        'format': _FORMAT,
        'program': [source_hash(module.__name__) for module in modules],
        'fold': fold,
        'trial': plain(trial),
    }


def plain(value: Any) -> Any:  # noqa: ANN401 - settings of settings
    """Return `value` as types of JSON; a NamedTuple becomes a dictionary."""
    if hasattr(value, '_asdict'):
        return {name: plain(part) for name, part in value._asdict().items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value


class ResultStore:
    """A folder with one file for the result of each finished trial."""

    def __init__(self, folder: Path) -> None:
        """Use `folder`, which is created with the first result."""
        self._folder = folder
        self._known: dict[Path, TrialResult] = {}

    def load(self, key: dict[str, object]) -> TrialResult | None:
        """Return the result of the trial with `key`, or None if it is not stored."""
        path = self._path(key)
        if path not in self._known:
            result = _read(path, key)
            if result is None:
                return None
            self._known[path] = result
        return self._known[path]

    def save(self, key: dict[str, object], result: TrialResult) -> None:
        """Store the result of the trial with `key`.

        Raises:
            InputError: the file cannot be written.
        """
        path = self._path(key)
        make_directory(self._folder)
        score = accuracy_of(result, tolerance=0.1)
        table = {
            # Error and mAP are for information, and are not read back.
            'mean_error_m': score.error,
            'map': score.fraction,
            'seconds': result.seconds,
            'frame_ms': result.frame_ms,
            'frames': result.frames,
            'joints': names_of(result.joints),
            'errors': _to_text(result.errors),
            'sizes': _to_text(result.sizes),
            'key': key,
        }
        write_output(path, JSON, (json.dumps(table, indent=1) + '\n').encode())
        self._known[path] = result

    def _path(self, key: dict[str, object]) -> Path:
        digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()
        return self._folder / f'{digest[:20]}.json'


def _read(path: Path, key: dict[str, object]) -> TrialResult | None:
    """Return the result in the file `path`; None if it is missing, damaged or of another trial."""
    try:
        table = json.loads(path.read_text(encoding='utf-8'))
        if table['key'] != json.loads(json.dumps(key)):
            return None
        joints = numbers_of(table['joints'])
        errors = _from_text(table['errors']).reshape(-1, len(joints))
        sizes = _from_text(table['sizes'])
        if len(sizes) != len(errors):
            return None
        frames, seconds = int(table['frames']), float(table['seconds'])
        frame_ms = None if table['frame_ms'] is None else float(table['frame_ms'])
        return TrialResult(joints, errors, sizes, frames, seconds, frame_ms)
    except (OSError, ValueError, KeyError, TypeError, InputError):
        return None


def _to_text(values: NDArray[np.float32]) -> str:
    return base64.b64encode(values.astype('<f4').tobytes()).decode()


def _from_text(text: str) -> NDArray[np.float32]:
    return np.frombuffer(base64.b64decode(text, validate=True), '<f4').astype(np.float32)
