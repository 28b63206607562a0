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

"""One thing that is measured: what to train, how to estimate; and what came of it."""

import base64
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation import evaluate
from lsc_pose_ros.evaluation.evaluate import Evaluation, summarise
from lsc_pose_ros.numerics.source_hash import source_hash
from lsc_pose_ros.training import train
from lsc_pose_ros.training.train import TrainingSettings
from lsc_pose_ros.viz.drawing.canvas import make_directory, write_beside

# To be raised where what a result holds, or how frames are drawn, changes.
_FORMAT = 1


class Trial(NamedTuple):
    """One model, tested in one way.

    Attributes:
        training: what is trained; a joint that is labelled nowhere is left out.
        frames: how many frames are learnt from, at most.
        graph: whether the pictorial structure ties the joints together.
    """

    training: TrainingSettings
    frames: int
    graph: bool = True


class Outcome(NamedTuple):
    """The errors of P labelled people.

    Attributes:
        joints: the joints' numbers, shape (J,).
        errors: metres, NaN where there is no truth, infinity where no estimate, shape (P, J).
        sizes: how large each person is beside the mean of all in the fold, shape (P,).
        frames: how many frames were learnt from; of several folds, on the average.
        seconds: how long the training took; of several folds, in all.
    """

    joints: NDArray[np.uint16]
    errors: NDArray[np.float32]
    sizes: NDArray[np.float32]
    frames: int
    seconds: float


class Score(NamedTuple):
    """A mean error in metres and a share within the tolerance; None where it is not known."""

    error: float | None = None
    share: float | None = None


def score_of(outcome: Outcome, tolerance: float) -> Score:
    """Return the mean error and mAP of `outcome` as `evaluate` counts; `tolerance` in metres."""
    labelled = outcome.errors[~np.isnan(outcome.errors)]
    if len(labelled) and np.isinf(labelled).all():
        return Score(None, 0.0)
    summary = summarise(_evaluation(outcome), tolerance)
    return Score(summary.mean_error_m, summary.map)


def _evaluation(outcome: Outcome) -> Evaluation:
    people = len(outcome.errors)
    return Evaluation(
        outcome.joints,
        outcome.errors,
        np.arange(people),
        np.zeros(people, np.uint16),
        np.zeros(people),
        np.zeros_like(outcome.errors),
        np.full((*outcome.errors.shape, 3), np.nan, np.float32),
    )


def join_outcomes(outcomes: Sequence[Outcome]) -> Outcome:
    """Return what came of all folds as one."""
    joints = np.unique(np.concatenate([outcome.joints for outcome in outcomes]))
    people = [
        np.full((len(outcome.errors), len(joints)), np.nan, np.float32) for outcome in outcomes
    ]
    for errors, outcome in zip(people, outcomes, strict=True):
        errors[:, np.isin(joints, outcome.joints)] = outcome.errors
    return Outcome(
        joints,
        np.concatenate(people),
        np.concatenate([outcome.sizes for outcome in outcomes]),
        round(sum(outcome.frames for outcome in outcomes) / len(outcomes)),
        sum(outcome.seconds for outcome in outcomes),
    )


def trial_key(fold: dict[str, object], trial: Trial) -> dict[str, object]:
    """Return all that decides what comes of `trial` in a fold, the program itself included."""
    return {
        'format': _FORMAT,
        'program': [source_hash(module.__name__) for module in (train, evaluate)],
        'fold': fold,
        'trial': plain(trial),
    }


def plain(value: Any) -> Any:  # noqa: ANN401 - settings of settings
    """Return `value` in the words of JSON; a NamedTuple becomes a table."""
    if hasattr(value, '_asdict'):
        return {name: plain(part) for name, part in value._asdict().items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value


class Store:
    """The folder that finished trials are kept in, a file each."""

    def __init__(self, folder: Path) -> None:
        """Keep trials in `folder`, which is made when the first one is kept."""
        self._folder = folder
        self._known: dict[Path, Outcome] = {}

    def load(self, key: dict[str, object]) -> Outcome | None:
        """Return what came of the trial with `key`, or None where that is not known."""
        path = self._path(key)
        if path not in self._known:
            outcome = _read(path, key)
            if outcome is None:
                return None
            self._known[path] = outcome
        return self._known[path]

    def save(self, key: dict[str, object], outcome: Outcome) -> None:
        """Keep what came of the trial with `key`.

        Raises:
            InputError: it cannot be written.
        """
        path = self._path(key)
        make_directory(self._folder)
        score = score_of(outcome, tolerance=0.1)
        table = {
            # For people to read; the program reads the errors.
            'mean_error_m': score.error,
            'map': score.share,
            'seconds': outcome.seconds,
            'frames': outcome.frames,
            'joints': names_of(outcome.joints),
            'errors': _to_text(outcome.errors),
            'sizes': _to_text(outcome.sizes),
            'key': key,
        }
        write_beside(path, (json.dumps(table, indent=1) + '\n').encode())
        self._known[path] = outcome

    def _path(self, key: dict[str, object]) -> Path:
        digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()
        return self._folder / f'{digest[:20]}.json'


def _read(path: Path, key: dict[str, object]) -> Outcome | None:
    """Return what the file `path` holds; a file that is damaged is as none, and written anew."""
    try:
        table = json.loads(path.read_text(encoding='utf-8'))
        if table['key'] != json.loads(json.dumps(key)):
            return None
        joints = numbers_of(table['joints'])
        errors = _from_text(table['errors']).reshape(-1, len(joints))
        sizes = _from_text(table['sizes'])
        if len(sizes) != len(errors):
            return None
        return Outcome(joints, errors, sizes, int(table['frames']), float(table['seconds']))
    except (OSError, ValueError, KeyError, TypeError, InputError):
        return None


def _to_text(values: NDArray[np.float32]) -> str:
    return base64.b64encode(values.astype('<f4').tobytes()).decode()


def _from_text(text: str) -> NDArray[np.float32]:
    return np.frombuffer(base64.b64decode(text, validate=True), '<f4').astype(np.float32)
