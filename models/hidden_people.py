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

# ruff: noqa: INP001 - part of a program, not of a package
"""Figures for the card: people who are hidden, cut off or seated, by the visibility of joints."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import HIDDEN, OUTSIDE, SEEN, UNKNOWN
from lsc_pose_ros.evaluation.evaluate import Evaluation
from lsc_pose_ros.training.samples import select_joints

BENT_HIPS = 130.0
"""Seated or crouched people have a smaller angle between trunk and thighs, degrees."""

_FEW, _MANY = 0.25, 0.75
"""Between these fractions of joints that are hidden, or outside, a person is half hidden."""


def hip_angle_of(ground_truth: Skeletons) -> NDArray[np.float64]:
    """Return the mean angle between trunk and thighs, degrees, shape (B,).

    It is 180 for people who stand upright, about 90 for seated ones.
    """
    positions = {
        name: select_joints(ground_truth, numbers_of([name]))[:, 0].astype(np.float64)
        for name in ('pelvis', 'neck', 'l_hip', 'l_knee', 'r_hip', 'r_knee')
    }
    trunk = positions['neck'] - positions['pelvis']
    angles = [_angle(trunk, positions[f'{side}_knee'] - positions[f'{side}_hip']) for side in 'lr']
    angle: NDArray[np.float64] = np.mean(angles, axis=0)
    return angle


def _angle(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    cosine = (first * second).sum(axis=1) / np.maximum(lengths, 1e-9)
    angle: NDArray[np.float64] = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return angle


def hidden_people_scores(
    evaluation: Evaluation, hip_angle: NDArray[np.float64], tolerance: float
) -> dict[str, Any]:
    """Return the figures of groups of people, by the name of the group; empty ones are left out.

    Args:
        evaluation: the errors of P people. Those without a seen joint are in no group.
        hip_angle: of each, degrees, shape (P,).
        tolerance: metres.
    """
    visibility = evaluation.visibility
    hidden = (visibility == HIDDEN).mean(axis=1)
    outside = (visibility == OUTSIDE).mean(axis=1)
    known = (visibility != UNKNOWN).any(axis=1) & (visibility == SEEN).any(axis=1)
    whole = (hidden + outside) <= 1 - 0.9
    bent = hip_angle < BENT_HIPS
    groups = {
        'whole, standing': whole & ~bent,
        'whole, hips bent (seated, crouched)': whole & bent,
        'half hidden by something': (hidden >= _FEW) & (hidden <= _MANY) & (outside < _FEW),
        'half cut off by the image': (outside >= _FEW) & (outside <= _MANY) & (hidden < _FEW),
    }
    return {
        name: _group_scores(evaluation, chosen & known, tolerance)
        for name, chosen in groups.items()
        if (chosen & known).any()
    }


def _group_scores(
    evaluation: Evaluation, chosen: NDArray[np.bool_], tolerance: float
) -> dict[str, Any]:
    errors, visibility = evaluation.errors[chosen], evaluation.visibility[chosen]
    confidence = evaluation.confidence[chosen]
    row: dict[str, Any] = {'people': int(chosen.sum())}
    for name, joints in (
        ('all', visibility != UNKNOWN),
        ('seen', visibility == SEEN),
        ('unseen', np.isin(visibility, (HIDDEN, OUTSIDE))),
    ):
        used = joints & ~np.isnan(errors)
        row[name] = float((errors[used] <= tolerance).mean()) if used.any() else None
        row[f'{name}_confidence'] = float(confidence[used].mean()) if used.any() else None
    return row
