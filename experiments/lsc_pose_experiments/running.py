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

"""Carries trials out: frames are described once, and trees grown once, for all that share them."""

import json
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.drawn_frames import restore
from lsc_pose_experiments.protocol import (
    Draws,
    Fold,
    FoldFrames,
    Study,
    fold_key,
    folds_of,
)
from lsc_pose_experiments.trial import Outcome, Store, Trial, join_outcomes, plain, trial_key
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, default_edges
from lsc_pose_ros.evaluation.evaluate import evaluate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.samples import (
    Person,
    Samples,
    gather_samples,
    most_samples,
    people_in,
    select_joints,
)
from lsc_pose_ros.training.train import TrainingSettings, train_on

# The settings that only estimation reads: models that differ in no other have the same forest.
_OF_ESTIMATION = (
    'query_points',
    'joint_bandwidth',
    'heaviest_votes',
    'candidates',
    'pair_weight',
    'legs_apart',
)

Progress = Callable[[str], None]


class Bench(NamedTuple):
    """Where trials are carried out.

    Attributes:
        study: what they are measured on.
        store: where finished ones are kept.
        read: opens a recording and yields its frames.
        tell: is told each step as it begins.
    """

    study: Study
    store: Store
    read: Callable[[Path], Iterable[Frame]]
    tell: Progress = lambda _step: None


def outcome_of(bench: Bench, trial: Trial) -> Outcome | None:
    """Return what came of `trial` in all folds, or None where one of them is not finished."""
    outcomes = []
    for fold in folds_of(bench.study):
        outcome = bench.store.load(trial_key(fold_key(bench.study, fold), trial))
        if outcome is None:
            return None
        outcomes.append(outcome)
    return join_outcomes(outcomes)


def run_trials(bench: Bench, trials: Sequence[Trial]) -> Iterator[Trial]:
    """Carry out those of `trials` that are not finished, and yield each once it is, fold by fold.

    Raises:
        InputError: a recording cannot be used.
    """
    folds = folds_of(bench.study)
    missing = [_missing(bench, fold, trials) for fold in folds]
    wanted = max((trial.frames for each in missing for trial in each), default=0)
    draws = Draws(bench.study, wanted, bench.read)
    for number, (fold, pending) in enumerate(zip(folds, missing, strict=True), 1):
        if pending:
            where = f'fold {number} of {len(folds)}: ' if len(folds) > 1 else ''
            yield from _run_fold(bench, (fold, draws.frames(fold)), pending, where)


def _missing(bench: Bench, fold: Fold, trials: Sequence[Trial]) -> list[Trial]:
    key = fold_key(bench.study, fold)
    unlike = {json.dumps(plain(trial)): trial for trial in trials}
    return [trial for trial in unlike.values() if bench.store.load(trial_key(key, trial)) is None]


def _run_fold(
    bench: Bench, divided: tuple[Fold, FoldFrames], pending: list[Trial], where: str
) -> Iterator[Trial]:
    fold, frames = divided
    key = fold_key(bench.study, fold)
    sizes = people_sizes(restore(frames.test))
    left = len(pending)
    for alike in _grouped(pending, _looks):
        described = _Described(frames, alike, bench.tell, where)
        for same in _grouped(alike, _forest):
            bench.tell(f'{where}training; {left} trials to go')
            model, seconds, count = described.train(same[0])
            for trial in same:
                settings = trial.training.settings
                estimator = Estimator(model._replace(settings=settings), graph=trial.graph)
                evaluation = evaluate(estimator, restore(frames.test))
                outcome = Outcome(model.joints, evaluation.errors, sizes, count, seconds)
                bench.store.save(trial_key(key, trial), outcome)
                left -= 1
                yield trial


def _grouped(trials: list[Trial], key: Callable[[Trial], str]) -> list[list[Trial]]:
    """Return `trials` by their keys, in the order in which these come first."""
    groups: dict[str, list[Trial]] = {}
    for trial in trials:
        groups.setdefault(key(trial), []).append(trial)
    return list(groups.values())


def _looks(trial: Trial) -> str:
    """Return what decides how a frame is described."""
    return json.dumps(plain(_without_estimation(trial.training.settings)))


def _forest(trial: Trial) -> str:
    """Return what decides the forest."""
    settings = _without_estimation(trial.training.settings)
    return json.dumps([plain(trial.training._replace(settings=settings)), trial.frames])


def _without_estimation(settings: Settings) -> Settings:
    return Settings(**(settings._asdict() | dict.fromkeys(_OF_ESTIMATION, 0)))


class _Described:
    """The frames to learn from, described in one way, for trials that all look so."""

    def __init__(
        self, frames: FoldFrames, trials: Sequence[Trial], tell: Progress, where: str
    ) -> None:
        wanted = min(max(trial.frames for trial in trials), len(frames.train))
        training = trials[0].training
        self._joints = np.unique(np.concatenate([trial.training.joints for trial in trials]))
        tell(f'{where}describing {wanted} frames')
        self._people: list[list[Person]] = [
            list(people_in(frame, self._joints, training.settings))
            for frame in restore(frames.train[:wanted])
        ]

    def train(self, trial: Trial) -> tuple[Model, float, int]:
        """Return the model, how long it took, seconds, and from how many frames it learnt."""
        begin = time.perf_counter()
        chosen = self._people[: trial.frames]
        samples, training = self._samples(chosen, trial.training)
        model = train_on(samples, training, {})
        return model, time.perf_counter() - begin, len(chosen)

    def _samples(
        self, people: list[list[Person]], training: TrainingSettings
    ) -> tuple[Samples, TrainingSettings]:
        """Return the samples, and `training` with those of its joints that they label."""
        # The people are held as well as the samples that are made of them.
        size = feature_size(training.settings)
        most = most_samples(0.5 * training.memory, len(self._joints), size)
        samples = gather_samples((person for frame in people for person in frame), most)
        labelled = ~np.isnan(samples.joints[..., 0]).all(axis=0)
        columns = np.flatnonzero(np.isin(self._joints, training.joints) & labelled)
        return (
            samples._replace(joints=np.ascontiguousarray(samples.joints[:, columns])),
            training._replace(joints=self._joints[columns]),
        )


def people_sizes(frames: Iterable[Frame]) -> NDArray[np.float32]:
    """Return how large each labelled person is, 1 the mean of all, in `evaluate`'s order, (P,).

    The size is the mean over the limbs that are labelled of their lengths, each divided by the
    mean over all people. Where no limb is labelled it is 1.
    """
    limbs = [_limb_lengths(frame) for frame in frames if frame.ground_truth is not None]
    lengths = np.concatenate(limbs)
    known = ~np.isnan(lengths)
    means = np.where(known, lengths, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    shares = lengths / np.where(means > 0, means, np.nan)
    counts = (~np.isnan(shares)).sum(axis=1)
    sizes = np.where(counts > 0, np.nansum(shares, axis=1) / np.maximum(counts, 1), 1.0)
    return sizes.astype(np.float32)


def _limb_lengths(frame: Frame) -> NDArray[np.float32]:
    if frame.ground_truth is None:
        raise AssertionError
    # All joints of the vocabulary, so that every frame has the same limbs.
    everything = np.arange(len(JOINT_NAMES), dtype=np.uint16)
    places = select_joints(frame.ground_truth, everything)
    edges = default_edges(everything)
    lengths: NDArray[np.float32] = np.linalg.norm(
        places[:, edges[:, 1]] - places[:, edges[:, 0]], axis=-1
    ).astype(np.float32)
    return lengths
