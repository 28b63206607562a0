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

"""The accuracy of a model: the errors of its joints on labelled frames (paper, section 4.4)."""

import time
from collections.abc import Callable, Iterable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.training.samples import select_joints


class JointEstimator(Protocol):
    """Estimates joints, as `lsc_pose_ros.pose.estimator.Estimator` does."""

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""

    def estimate(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
    ) -> Skeletons:
        """Return the joints of each body in `labels`, in the order of the bodies' numbers."""


class Evaluation(NamedTuple):
    """The errors of P labelled people in F frames.

    Attributes:
        joints: the joints' numbers, shape (J,).
        errors: the distance between estimate and ground truth, metres, shape (P, J); NaN without
            ground truth, infinity without estimate.
        frames: the number of each person's frame, counted from 0, shape (P,).
        bodies: the number of each person in the mask, shape (P,).
        seconds: the time of each frame's estimate, shape (F,).
        confidence: the confidence in each joint, 0 without estimate, shape (P, J).
        differences: ground truth minus estimate in the camera frame, metres, shape (P, J, 3); NaN
            if either is missing.
        visibility: of each joint, as in `lsc_pose_ros.data_types.visibility`, shape (P, J);
            UNKNOWN if the ground truth does not have it.
    """

    joints: NDArray[np.uint16]
    errors: NDArray[np.float32]
    frames: NDArray[np.int64]
    bodies: NDArray[np.uint16]
    seconds: NDArray[np.float64]
    confidence: NDArray[np.float32]
    differences: NDArray[np.float32]
    visibility: NDArray[np.uint8]


class JointScore(NamedTuple):
    """One joint's score.

    Attributes:
        mean_error_m: the mean error over the people for whom it was estimated, NaN if for none.
        ap: the fraction of the labelled people for whom it was estimated within the tolerance.
        n: the number of people who have it labelled.
    """

    mean_error_m: float
    ap: float
    n: int


class Summary(NamedTuple):
    """The scores over all labelled joints.

    Attributes:
        mean_error_m: the mean of the joints' mean errors.
        map: the mean of the joints' fractions within the tolerance.
        joints: each joint's score by name.
    """

    mean_error_m: float
    map: float
    joints: dict[str, JointScore]


def evaluate(
    estimator: JointEstimator,
    frames: Iterable[Frame],
    observe: Callable[[Frame, Skeletons], None] | None = None,
) -> Evaluation:
    """Return the errors of `estimator` on each labelled person of `frames`.

    Estimate and ground truth of a person have the same number in the mask.

    Args:
        estimator: estimates each frame alone.
        frames: the labelled frames.
        observe: called with each frame and its estimate.

    Raises:
        InputError: no frame is labelled, or no mask shows anybody.
    """
    errors: list[NDArray[np.float32]] = []
    numbers: list[NDArray[np.int64]] = []
    bodies: list[NDArray[np.uint16]] = []
    seconds: list[float] = []
    confidence: list[NDArray[np.float32]] = []
    differences: list[NDArray[np.float32]] = []
    visibility: list[NDArray[np.uint8]] = []
    estimated_bodies = 0
    for number, frame in enumerate(frames):
        begin = time.perf_counter()
        skeletons = estimator.estimate(frame.depth, frame.labels, frame.camera)
        seconds.append(time.perf_counter() - begin)
        estimated_bodies += len(skeletons.bodies)
        if observe is not None:
            observe(frame, skeletons)
        if frame.ground_truth is not None and len(frame.ground_truth.bodies):
            errors.append(joint_errors(skeletons, frame.ground_truth))
            confidence.append(joint_confidence(skeletons, frame.ground_truth))
            differences.append(joint_differences(skeletons, frame.ground_truth))
            visibility.append(visibility_of(frame.ground_truth, estimator.joints))
            bodies.append(frame.ground_truth.bodies)
            numbers.append(np.full(len(frame.ground_truth.bodies), number))
    if not errors:
        msg = 'no frame has a labelled person; evaluation needs a recording with ground truth'
        raise InputError(msg)
    if not estimated_bodies:
        msg = f'the masks of all {len(seconds)} frames are empty; is --mask-background right?'
        raise InputError(msg)
    return Evaluation(
        estimator.joints,
        np.concatenate(errors),
        np.concatenate(numbers),
        np.concatenate(bodies),
        np.array(seconds),
        np.concatenate(confidence),
        np.concatenate(differences),
        np.concatenate(visibility),
    )


def select(evaluation: Evaluation, joints: NDArray[np.uint16]) -> Evaluation:
    """Return `evaluation` of `joints` only, shape (J',), in the order of the model.

    Raises:
        InputError: the model does not estimate one of them.
    """
    missing = joints[~np.isin(joints, evaluation.joints)]
    if len(missing):
        msg = (
            f'the model does not estimate {", ".join(names_of(missing))}; '
            f'its joints are {", ".join(names_of(evaluation.joints))}'
        )
        raise InputError(msg)
    kept = np.isin(evaluation.joints, joints)
    return evaluation._replace(
        joints=evaluation.joints[kept],
        errors=evaluation.errors[:, kept],
        confidence=evaluation.confidence[:, kept],
        differences=evaluation.differences[:, kept],
        visibility=evaluation.visibility[:, kept],
    )


def joint_errors(estimate: Skeletons, ground_truth: Skeletons) -> NDArray[np.float32]:
    """Return the distances between `estimate` and each body of `ground_truth`, metres, (B, J).

    J are the joints of `estimate`. NaN without ground truth, infinity without estimate.
    """
    difference = joint_differences(estimate, ground_truth)
    labelled = ~np.isnan(select_joints(ground_truth, estimate.joints)[..., 0])
    distance: NDArray[np.float32] = np.linalg.norm(difference, axis=-1).astype(np.float32)
    distance[np.isnan(distance) & labelled] = np.inf
    return distance


def joint_differences(estimate: Skeletons, ground_truth: Skeletons) -> NDArray[np.float32]:
    """Return `ground_truth` minus `estimate`, metres, NaN where one is missing, (B, J, 3)."""
    wanted = select_joints(ground_truth, estimate.joints)
    found = np.full_like(wanted, np.nan)
    for b, row in _rows_of(ground_truth, estimate):
        found[b] = estimate.positions[row]
    difference: NDArray[np.float32] = wanted - found
    return difference


def joint_confidence(estimate: Skeletons, ground_truth: Skeletons) -> NDArray[np.float32]:
    """Return the confidence of each body of `ground_truth`, 0 if not estimated, (B, J)."""
    confidence = np.zeros((len(ground_truth.bodies), len(estimate.joints)), np.float32)
    for b, row in _rows_of(ground_truth, estimate):
        confidence[b] = estimate.confidence[row]
    return confidence


def visibility_of(ground_truth: Skeletons, joints: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Return the visibility of `joints`, shape (J,), in each body of `ground_truth`, (B, J)."""
    visibility = np.full((len(ground_truth.bodies), len(joints)), UNKNOWN, np.uint8)
    columns = {int(number): column for column, number in enumerate(ground_truth.joints)}
    for column, number in enumerate(joints):
        if ground_truth.visibility is not None and int(number) in columns:
            visibility[:, column] = ground_truth.visibility[:, columns[int(number)]]
    return visibility


def _rows_of(ground_truth: Skeletons, estimate: Skeletons) -> list[tuple[int, int]]:
    """Return the rows in both of each body that is in both."""
    rows = {int(number): row for row, number in enumerate(estimate.bodies)}
    return [
        (b, rows[int(number)])
        for b, number in enumerate(ground_truth.bodies)
        if int(number) in rows
    ]


def summarise(evaluation: Evaluation, tolerance: float) -> Summary:
    """Return the scores for a tolerance in metres (tau in the paper, 0.1)."""
    joints: dict[str, JointScore] = {}
    for name, errors in zip(names_of(evaluation.joints), evaluation.errors.T, strict=True):
        labelled = errors[~np.isnan(errors)]
        estimated = labelled[np.isfinite(labelled)]
        if len(labelled):
            joints[name] = JointScore(
                float(estimated.mean()) if len(estimated) else float('nan'),
                float((labelled <= tolerance).mean()),
                len(labelled),
            )
    if not joints:
        msg = 'the recordings label none of the joints that the model estimates'
        raise InputError(msg)
    return Summary(
        float(np.nanmean([score.mean_error_m for score in joints.values()])),
        float(np.mean([score.ap for score in joints.values()])),
        joints,
    )
