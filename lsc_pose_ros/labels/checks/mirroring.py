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

"""Left and right of labels, by comparison with a model's estimates."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS

# Differences beyond this count no more, metres.
_LARGEST = 0.5

# One reading fits better than another if its differences are smaller by this factor.
_CLEARLY = 0.75

# From this fraction of the bodies on, all are exchanged or mirrored.
_MOST = 0.6

_PAIRED = [
    (JOINT_NUMBERS[name], JOINT_NUMBERS[f'r_{name[2:]}'])
    for name in JOINT_NAMES
    if name.startswith('l_')
]


class SideDifferences(NamedTuple):
    """The mean differences of one body to the estimates in three readings, metres; NaN if unknown.

    Attributes:
        same: as it is labelled.
        exchanged: with left and right exchanged.
        mirrored: with x negated.
    """

    same: float
    exchanged: float
    mirrored: float


class SideReport(NamedTuple):
    """How labels and estimates agree about left and right.

    Attributes:
        bodies: how many could be compared.
        exchanged: the fraction that fits clearly better with left and right exchanged.
        mirrored: the fraction that fits clearly better with x negated.
    """

    bodies: int
    exchanged: float
    mirrored: float

    @property
    def all_exchanged(self) -> bool:
        """Whether left and right are exchanged throughout."""
        return self.exchanged > _MOST

    @property
    def all_mirrored(self) -> bool:
        """Whether the x axis of the labels is that of a mirrored image."""
        return self.mirrored > _MOST and not self.all_exchanged


def side_differences(
    labels: NDArray[np.floating], estimates: NDArray[np.floating]
) -> SideDifferences:
    """Return how one body's labels fit the estimates, both of shape (20, 3)."""
    left, right = np.array(_PAIRED).T
    exchanged = labels.copy()
    exchanged[left], exchanged[right] = labels[right], labels[left]
    mirrored = labels * np.array([-1.0, 1.0, 1.0])
    paired = np.concatenate([left, right])
    return SideDifferences(
        _mean(labels[paired] - estimates[paired]),
        _mean(exchanged[paired] - estimates[paired]),
        _mean(mirrored - estimates),
    )


def is_exchanged(differences: SideDifferences) -> bool:
    """Return whether one body fits clearly better with left and right exchanged."""
    return differences.exchanged < _CLEARLY * differences.same


def side_report(differences: list[SideDifferences]) -> SideReport:
    """Return what the differences of many bodies tell."""
    known = [each for each in differences if np.isfinite([each.same, each.exchanged]).all()]
    if not known:
        return SideReport(0, 0.0, 0.0)
    exchanged = np.mean([is_exchanged(each) for each in known])
    mirrored = np.mean([each.mirrored < _CLEARLY * each.same for each in known])
    return SideReport(len(known), float(exchanged), float(mirrored))


def _mean(differences: NDArray[np.floating]) -> float:
    lengths = np.linalg.norm(differences, axis=-1)
    lengths = lengths[np.isfinite(lengths)]
    return float(np.minimum(lengths, _LARGEST).mean()) if lengths.size else float('nan')
