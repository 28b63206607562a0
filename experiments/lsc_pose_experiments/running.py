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

"""Runs trials: those with equal descriptors or forests compute these only once."""

import itertools
import json
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.protocol import (
    DataSelection,
    Fold,
    FoldFrames,
    FrameSampler,
    fold_key,
    folds_of,
)
from lsc_pose_experiments.rivals import RIVALS
from lsc_pose_experiments.sampled_frames import decode_frames
from lsc_pose_experiments.trial import (
    ResultStore,
    Trial,
    TrialResult,
    join_results,
    plain,
    trial_key,
)
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, default_edges
from lsc_pose_ros.evaluation.evaluate import JointEstimator, evaluate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.samples import (
    LabelledPerson,
    Samples,
    gather_samples,
    labelled_people_in,
    sample_limit,
    select_joints,
)
from lsc_pose_ros.training.train import TrainingSettings, train_on

# Settings that only estimation uses: models that differ only in these have the same forest.
_ESTIMATION_SETTINGS = (
    'query_points',
    'joint_bandwidth',
    'heaviest_votes',
    'candidates',
    'pair_weight',
    'legs_apart',
)

Progress = Callable[[str], None]


class TrialContext(NamedTuple):
    """What trials need.

    Attributes:
        selection: the recordings.
        store: the stored results.
        read: opens a recording and yields its frames.
        progress: called with a description of each step as it begins.
    """

    selection: DataSelection
    store: ResultStore
    read: Callable[[Path], Iterable[Frame]]
    progress: Progress = lambda _step: None


def result_of(context: TrialContext, trial: Trial) -> TrialResult | None:
    """Return the result of `trial` over all folds, or None if one is not finished."""
    results = []
    for fold in folds_of(context.selection):
        result = context.store.load(trial_key(fold_key(context.selection, fold), trial))
        if result is None:
            return None
        results.append(result)
    return join_results(results)


def run_trials(context: TrialContext, trials: Sequence[Trial]) -> Iterator[Trial]:
    """Run the unfinished ones of `trials`, fold by fold, and yield each as it finishes.

    Raises:
        InputError: a recording cannot be used.
    """
    folds = folds_of(context.selection)
    missing = [_missing(context, fold, trials) for fold in folds]
    wanted = max((trial.frames for each in missing for trial in each), default=0)
    draws = FrameSampler(context.selection, wanted, context.read)
    for number, (fold, pending) in enumerate(zip(folds, missing, strict=True), 1):
        if pending:
            where = f'fold {number} of {len(folds)}: ' if len(folds) > 1 else ''
            yield from _run_fold(context, (fold, draws.frames(fold)), pending, where)


def _missing(context: TrialContext, fold: Fold, trials: Sequence[Trial]) -> list[Trial]:
    key = fold_key(context.selection, fold)
    unlike = {json.dumps(plain(trial)): trial for trial in trials}
    return [
        trial for trial in unlike.values() if context.store.load(trial_key(key, trial)) is None
    ]


def _run_fold(
    context: TrialContext, divided: tuple[Fold, FoldFrames], pending: list[Trial], where: str
) -> Iterator[Trial]:
    fold, frames = divided
    key = fold_key(context.selection, fold)
    sizes = relative_body_sizes(decode_frames(frames.test))
    for trial, ready in itertools.chain(
        _forest_trials(context, frames, pending, where),
        _rival_trials(context, frames, pending, where),
    ):
        evaluation = evaluate(ready.estimator, decode_frames(frames.test))
        result = TrialResult(
            ready.estimator.joints,
            evaluation.errors,
            sizes,
            ready.frames,
            ready.seconds,
            1000 * float(np.median(evaluation.seconds)),
        )
        context.store.save(trial_key(key, trial), result)
        yield trial


class _Trained(NamedTuple):
    """An estimator, the number of its training frames, and the duration of its training."""

    estimator: JointEstimator
    frames: int
    seconds: float


def _forest_trials(
    context: TrialContext, frames: FoldFrames, pending: Sequence[Trial], where: str
) -> Iterator[tuple[Trial, _Trained]]:
    """Yield the trials of the method of the paper, which share work."""
    left = len(pending)
    mine = [trial for trial in pending if trial.rival is None]
    for alike in _grouped(mine, _description_key):
        described = _DescribedFrames(frames, alike, context.progress, where)
        for same in _grouped(alike, _forest_key):
            context.progress(f'{where}training; {left} trials left')
            model, seconds, count = described.train(same[0])
            for trial in same:
                settings = trial.training.settings
                estimator = Estimator(model._replace(settings=settings), graph=trial.graph)
                yield trial, _Trained(estimator, count, seconds)
                left -= 1


def _rival_trials(
    context: TrialContext, frames: FoldFrames, pending: Sequence[Trial], where: str
) -> Iterator[tuple[Trial, _Trained]]:
    """Yield the trials of the rivals with estimators of their own."""
    for trial in pending:
        if trial.rival is not None:
            rival = RIVALS[type(trial.rival)]
            context.progress(f'{where}training {rival.name}')
            begin = time.perf_counter()
            chosen = frames.train[: trial.frames]
            model = rival.train(chosen, trial.training.joints, trial.rival, trial.training.seed)
            seconds = time.perf_counter() - begin
            yield trial, _Trained(rival.make(model), len(chosen), seconds)


def _grouped(trials: Sequence[Trial], key: Callable[[Trial], str]) -> list[list[Trial]]:
    """Return `trials` grouped by key, in the order of the first trial of each group."""
    groups: dict[str, list[Trial]] = {}
    for trial in trials:
        groups.setdefault(key(trial), []).append(trial)
    return list(groups.values())


def _description_key(trial: Trial) -> str:
    """Return the settings that determine the descriptors of a frame."""
    return json.dumps(plain(_without_estimation(trial.training.settings)))


def _forest_key(trial: Trial) -> str:
    """Return the settings that determine the forest."""
    settings = _without_estimation(trial.training.settings)
    return json.dumps([plain(trial.training._replace(settings=settings)), trial.frames])


def _without_estimation(settings: Settings) -> Settings:
    return Settings(**(settings._asdict() | dict.fromkeys(_ESTIMATION_SETTINGS, 0)))


class _DescribedFrames:
    """Descriptors of the training frames, for trials with equal settings of the descriptor."""

    def __init__(
        self, frames: FoldFrames, trials: Sequence[Trial], progress: Progress, where: str
    ) -> None:
        wanted = min(max(trial.frames for trial in trials), len(frames.train))
        training = trials[0].training
        self._joints = np.unique(np.concatenate([trial.training.joints for trial in trials]))
        progress(f'{where}describing {wanted} frames')
        self._people: list[list[LabelledPerson]] = [
            list(labelled_people_in(frame, self._joints, training.settings))
            for frame in decode_frames(frames.train[:wanted])
        ]

    def train(self, trial: Trial) -> tuple[Model, float, int]:
        """Return the model, the duration of its training, seconds, and the number of frames."""
        begin = time.perf_counter()
        chosen = self._people[: trial.frames]
        samples, training = self._samples(chosen, trial.training)
        model = train_on(samples, training, {})
        return model, time.perf_counter() - begin, len(chosen)

    def _samples(
        self, people: list[list[LabelledPerson]], training: TrainingSettings
    ) -> tuple[Samples, TrainingSettings]:
        """Return the samples, and `training` without joints that are never labelled."""
        # The people stay in memory beside the samples, hence half of the memory.
        size = feature_size(training.settings)
        most = sample_limit(0.5 * training.memory, len(self._joints), size)
        samples = gather_samples((person for frame in people for person in frame), most)
        labelled = ~np.isnan(samples.joints[..., 0]).all(axis=0)
        columns = np.flatnonzero(np.isin(self._joints, training.joints) & labelled)
        return (
            samples._replace(joints=np.ascontiguousarray(samples.joints[:, columns])),
            training._replace(joints=self._joints[columns]),
        )


def relative_body_sizes(frames: Iterable[Frame]) -> NDArray[np.float32]:
    """Return the size of each labelled person relative to the mean, shape (P,).

    The size is the mean over the labelled limbs of the length divided by the mean length over all
    people; 1 if no limb is labelled. The order is that of `evaluate`.
    """
    limbs = [_limb_lengths(frame) for frame in frames if frame.ground_truth is not None]
    lengths = np.concatenate(limbs)
    known = ~np.isnan(lengths)
    means = np.where(known, lengths, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    fractions = lengths / np.where(means > 0, means, np.nan)
    counts = (~np.isnan(fractions)).sum(axis=1)
    sizes = np.where(counts > 0, np.nansum(fractions, axis=1) / np.maximum(counts, 1), 1.0)
    return sizes.astype(np.float32)


def _limb_lengths(frame: Frame) -> NDArray[np.float32]:
    if frame.ground_truth is None:
        raise AssertionError
    # With all joints of the vocabulary, all frames have the same limbs.
    everything = np.arange(len(JOINT_NAMES), dtype=np.uint16)
    positions = select_joints(frame.ground_truth, everything)
    edges = default_edges(everything)
    lengths: NDArray[np.float32] = np.linalg.norm(
        positions[:, edges[:, 1]] - positions[:, edges[:, 0]], axis=-1
    ).astype(np.float32)
    return lengths
