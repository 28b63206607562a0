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

"""How reliable the confidence is: of the joints with confidence c, a fraction c should be near.

The expected calibration error is the mean of |confidence - fraction| over all labelled joints,
both taken in bins of confidence (Naeini, Cooper, Hauskrecht, AAAI 2015). It can be 0 even if all
confidences are equal. The Brier score, the mean of (confidence - outcome)^2, also measures how
well the confidence separates near joints from others.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.evaluation.evaluate import Evaluation
from lsc_pose_ros.pose.inference.confidence import NEAR

BINS = 10


class Bin(NamedTuple):
    """The joints with a confidence from `least` to `most`.

    Attributes:
        least: inclusive.
        most: exclusive, except for the last bin.
        confidence: their mean confidence.
        fraction: the fraction of them within NEAR of the ground truth.
        n: their number.
    """

    least: float
    most: float
    confidence: float
    fraction: float
    n: int


class Reliability(NamedTuple):
    """The reliability of the confidence.

    Attributes:
        within_m: NEAR, the distance from the ground truth up to which a joint is near, metres.
        ece: the expected calibration error over all labelled joints.
        brier: their Brier score.
        joints: the expected calibration error of each joint by name.
        bins: the bins that are not empty, over all labelled joints.
    """

    within_m: float
    ece: float
    brier: float
    joints: dict[str, float]
    bins: list[Bin]


def measure_reliability(evaluation: Evaluation) -> Reliability:
    """Return how well the confidences of `evaluation` fit its errors.

    A joint that was not estimated has confidence 0 and is not near.
    """
    labelled = ~np.isnan(evaluation.errors)
    near = evaluation.errors <= NEAR
    confidence = evaluation.confidence.astype(np.float64)
    outcomes = near[labelled]
    bins = bin_by_confidence(confidence[labelled], outcomes)
    joints = {
        name: expected_error(bin_by_confidence(confidence[rows, j], near[rows, j]))
        for j, (name, rows) in enumerate(zip(names_of(evaluation.joints), labelled.T, strict=True))
        if rows.any()
    }
    brier = float(np.mean((confidence[labelled] - outcomes) ** 2))
    return Reliability(NEAR, expected_error(bins), brier, joints, bins)


def bin_by_confidence(
    confidence: NDArray[np.float64], near: NDArray[np.bool_], count: int = BINS
) -> list[Bin]:
    """Return those of `count` evenly spaced bins that are not empty.

    Args:
        confidence: 0 to 1, shape (n,).
        near: whether the joint is within NEAR of the ground truth, shape (n,).
        count: the number of bins.
    """
    numbers = np.minimum((confidence * count).astype(np.int64), count - 1)
    return [
        Bin(
            int(number) / count,
            (int(number) + 1) / count,
            float(confidence[numbers == number].mean()),
            float(near[numbers == number].mean()),
            int((numbers == number).sum()),
        )
        for number in np.unique(numbers)
    ]


def expected_error(bins: list[Bin]) -> float:
    """Return the expected calibration error: sum over bins of n/N |confidence - fraction|."""
    total = sum(each.n for each in bins)
    return sum(each.n * abs(each.confidence - each.fraction) for each in bins) / total
