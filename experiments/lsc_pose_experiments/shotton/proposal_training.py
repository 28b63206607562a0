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

"""The choice of bandwidth, probability threshold and depth offset of a part."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.shotton.joint_proposals import (
    ProposalSettings,
    push_back,
    surface_proposal,
)
from lsc_pose_experiments.shotton.part_pixels import PartCloud

BANDWIDTHS = (0.03, 0.05, 0.065, 0.09, 0.12, 0.16)
"""The bandwidths that are tried, metres; the mean in the paper is 0.065."""

THRESHOLDS = (0.05, 0.14, 0.3, 0.5)
"""The thresholds that are tried; the mean in the paper is 0.14."""

USUAL = ProposalSettings(0.065, 0.14, 0.039)
"""The means in the paper, for a part that no held-out person shows."""

TOLERANCE = 0.1
"""The distance up to which a proposal is right, metres (tau in the paper)."""

# Only proposals on the right surface tell how deep the joint is below it, metres.
_FARTHEST_SIDEWAYS = 0.1


def choose_settings(clouds: Sequence[PartCloud], joints: NDArray[np.float32]) -> ProposalSettings:
    """Return the settings with which most proposals are right; a grid search.

    The paper chooses them on 5,000 images that the forest has not learned.

    Args:
        clouds: the pixels of the part for each of P people.
        joints: the position of the joint, metres, NaN if not labelled, shape (P, 3).
    """
    shown = ~np.isnan(joints[:, 0])
    if not shown.any():
        return USUAL
    labelled = [cloud for cloud, known in zip(clouds, shown, strict=True) if known]
    best, best_score = USUAL, (-1.0, 0.0)
    for bandwidth in BANDWIDTHS:
        for threshold in THRESHOLDS:
            proposals = [surface_proposal(cloud, bandwidth, threshold) for cloud in labelled]
            found = np.array([proposal[:3] for proposal in proposals], np.float32)
            offset = depth_offset(found, joints[shown])
            score = _score(found, joints[shown], offset)
            if score > best_score:
                best, best_score = ProposalSettings(bandwidth, threshold, offset), score
    return best


def depth_offset(surface: NDArray[np.float32], joints: NDArray[np.float32]) -> float:
    """Return the median depth of joints behind the proposals on the surface, metres.

    Args:
        surface: the proposals, metres, NaN for none, shape (P, 3).
        joints: the joints, metres, shape (P, 3). If none of them is near the ray of its
            proposal, the offset is that of USUAL.
    """
    behind = joints[:, 2] - surface[:, 2]
    pushed = surface * (joints[:, 2:] / surface[:, 2:])
    sideways = np.linalg.norm(joints - pushed, axis=1)
    right = sideways <= _FARTHEST_SIDEWAYS
    return float(np.median(behind[right])) if right.any() else USUAL.depth_offset


def _score(
    surface: NDArray[np.float32], joints: NDArray[np.float32], offset: float
) -> tuple[float, float]:
    """Return the fraction of right proposals, and minus the mean error of these."""
    errors = np.linalg.norm(push_back(surface, offset) - joints, axis=1)
    right = errors <= TOLERANCE
    return float(right.mean()), -float(errors[right].mean()) if right.any() else 0.0
