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

"""The check of a labelled recording: all that is told about its labels."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.evaluation.evaluate import JointEstimator
from lsc_pose_ros.labels.checks.mirroring import (
    SideDifferences,
    SideReport,
    is_exchanged,
    side_differences,
    side_report,
)
from lsc_pose_ros.labels.checks.problems import (
    KINDS,
    LIMBS,
    LabelLimits,
    find_problems,
    limb_lengths,
)
from lsc_pose_ros.labels.checks.timing import LabelledSequence, Lag, find_lag
from lsc_pose_ros.labels.checks.worst_frames import WorstFrame, WorstFrames
from lsc_pose_ros.training.samples import select_joints

# A longer pause, in typical steps between stamps, starts a new sequence.
_PAUSE = 2.5

# Limbs are compared with those of so long before and after, nanoseconds.
_AROUND = 1_000_000_000

# Further from the estimates, labels are in another place, not in another anatomy; metres.
_ELSEWHERE = 0.5


@dataclass
class LabelReport:
    """What a check has found.

    Attributes:
        frames: all frames.
        labelled_frames: those with a labelled body.
        joints: the labelled joints of all frames.
        problems: how many joints have each kind of problem.
        lag: between labels and depth; None if it cannot be told.
        sides: left and right.
        length_spread: the relative spread of each limb's length, half the range of the middle
            90 %, by the name of the limb's far joint.
        difference: the median distance between label and estimate, metres.
        worst: the worst frames, the worst first.
        model: the name of the model, '' if it is not known.
    """

    frames: int = 0
    labelled_frames: int = 0
    joints: int = 0
    problems: dict[str, int] = field(default_factory=lambda: dict.fromkeys(KINDS, 0))
    lag: Lag | None = None
    sides: SideReport = SideReport(0, 0.0, 0.0)  # noqa: RUF009 - a tuple
    length_spread: dict[str, float] = field(default_factory=dict)
    difference: float = float('nan')
    worst: list[WorstFrame] = field(default_factory=list)
    model: str = ''

    @property
    def elsewhere(self) -> bool:
        """Whether the labels are so far from the estimates that their unit or frame is wrong."""
        return self.difference > _ELSEWHERE

    @property
    def lag_found(self) -> bool:
        """Whether labels and depth are apart in time, which only labels in place can tell."""
        return self.lag is not None and self.lag.found and not self.elsewhere


class LabelStudy:
    """Collects what is needed for a report, one frame after the other."""

    def __init__(
        self,
        estimator: JointEstimator,
        limits: LabelLimits,
        usual_lengths: 'UsualLengths',
        shown: int,
    ) -> None:
        """Start with no frames.

        Args:
            estimator: estimates the frames that are compared.
            limits: how far off a label may be.
            usual_lengths: of the limbs of each body in these frames.
            shown: how many of the worst frames are kept.
        """
        self._estimator = estimator
        self._limits = limits
        self._usual = usual_lengths
        self._report = LabelReport()
        self._worst = WorstFrames(shown)
        self._sequences: dict[int, list[tuple[int, NDArray[np.float64], NDArray[np.float64]]]] = (
            defaultdict(list)
        )
        self._sides: list[SideDifferences] = []
        self._lengths: list[NDArray[np.float64]] = []

    def add(self, number: int, frame: Frame, *, compare: bool) -> None:
        """Check the labels of a frame; `compare` them with the estimates of the model, too."""
        report = self._report
        report.frames += 1
        truth = frame.ground_truth
        if truth is None or not known_bodies(truth):
            return
        labels = with_all_joints(truth)
        report.labelled_frames += 1
        report.joints += int(np.isfinite(labels.positions).all(axis=-1).sum())
        problems = self._problems(frame, labels)
        estimate = None
        exchanged = 0
        if compare:
            estimate = self._estimator.estimate(frame.depth, frame.labels, frame.camera)
            exchanged = self._compare(frame, labels, estimate)
        full = frame._replace(ground_truth=labels)
        self._worst.add(number, full, estimate, problems, exchanged)

    def report(self) -> LabelReport:
        """Return what was found."""
        report = self._report
        report.lag = find_lag(list(self._all_sequences()))
        report.sides = side_report(self._sides)
        report.worst = self._worst.found()
        report.length_spread = self._spread()
        distances = [
            np.linalg.norm(labels - estimate, axis=-1)
            for frames in self._sequences.values()
            for _, labels, estimate in frames
        ]
        known = np.concatenate(distances) if distances else np.zeros(0)
        known = known[np.isfinite(known)]
        report.difference = float(np.median(known)) if known.size else float('nan')
        return report

    def _problems(self, frame: Frame, labels: Skeletons) -> dict[str, NDArray[np.bool_]]:
        problems = find_problems(frame, labels, self._limits, self._usual.at(frame.stamp))
        self._lengths.extend(limb_lengths(labels.positions))
        for kind, joints in problems.items():
            self._report.problems[kind] += int(joints.sum())
        return problems

    def _compare(self, frame: Frame, labels: Skeletons, estimate: Skeletons) -> int:
        """Compare the bodies that are labelled and estimated; return how many are exchanged."""
        estimates = with_all_joints(estimate)
        rows = {body: row for row, body in enumerate(estimates.bodies.tolist())}
        exchanged = 0
        for row, body in enumerate(labels.bodies.tolist()):
            if body not in rows:
                continue
            pair = (
                labels.positions[row].astype(np.float64),
                estimates.positions[rows[body]].astype(np.float64),
            )
            self._sequences[body].append((frame.stamp, *pair))
            differences = side_differences(*pair)
            self._sides.append(differences)
            exchanged += is_exchanged(differences)
        return exchanged

    def _all_sequences(self) -> Iterator[LabelledSequence]:
        for frames in self._sequences.values():
            stamps = np.array([stamp for stamp, _, _ in frames], np.int64)
            steps = np.diff(stamps)
            longest = _PAUSE * np.median(steps) if len(steps) else 0
            cuts = [0, *(np.flatnonzero((steps > longest) | (steps <= 0)) + 1), len(frames)]
            for first, last in pairwise(cuts):
                part = frames[first:last]
                yield LabelledSequence(
                    stamps[first:last],
                    np.array([labels for _, labels, _ in part]),
                    np.array([estimate for _, _, estimate in part]),
                )

    def _spread(self) -> dict[str, float]:
        spread: dict[str, float] = {}
        lengths = np.array(self._lengths).reshape(-1, len(LIMBS))
        for column, (_, child) in enumerate(LIMBS):
            known = lengths[:, column][np.isfinite(lengths[:, column])]
            if known.size and np.median(known) > 0:
                low, middle, high = np.quantile(known, [0.05, 0.5, 0.95])
                spread[JOINT_NAMES[child]] = float((high - low) / 2 / middle)
        return spread


class UsualLengths:
    """The lengths of the limbs of each body around a moment.

    They are medians over the labels of the same number within a second before and after, because
    a number can be that of different people in one recording.
    """

    def __init__(self, frames: Iterable[Frame]) -> None:
        """Measure the labels of `frames`, which are in the order of time."""
        stamps: dict[int, list[int]] = defaultdict(list)
        lengths: dict[int, list[NDArray[np.float64]]] = defaultdict(list)
        for frame in frames:
            if frame.ground_truth is None:
                continue
            labels = with_all_joints(frame.ground_truth)
            for body, positions in zip(labels.bodies.tolist(), labels.positions, strict=True):
                stamps[body].append(frame.stamp)
                lengths[body].append(limb_lengths(positions))
        self._stamps = {body: np.array(each, np.int64) for body, each in stamps.items()}
        self._lengths = {body: np.array(each) for body, each in lengths.items()}

    def at(self, stamp: int) -> dict[int, NDArray[np.float64]]:
        """Return the usual lengths of LIMBS, metres, shape (L,) by body number."""
        usual: dict[int, NDArray[np.float64]] = {}
        for body, stamps in self._stamps.items():
            first, last = np.searchsorted(stamps, [stamp - _AROUND, stamp + _AROUND + 1])
            if last > first:
                usual[body] = _medians(self._lengths[body][first:last])
        return usual


def _medians(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the medians of the columns without NaN, NaN for a column of nothing else."""
    columns = [values[np.isfinite(values)] for values in lengths.T]
    return np.array([np.median(values) if values.size else np.nan for values in columns])


def with_all_joints(skeletons: Skeletons) -> Skeletons:
    """Return `skeletons` with all 20 joints, NaN for those that it does not have."""
    joints = np.arange(len(JOINT_NAMES), dtype=np.uint16)
    positions = select_joints(skeletons, joints).astype(np.float32)
    confidence = np.asarray(np.isfinite(positions).all(axis=-1), np.float32)
    return Skeletons(skeletons.bodies, joints, positions, confidence)
