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

"""Accuracy and confidence of joints that the camera sees, and of those that it does not see."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.visibility import VISIBILITIES
from lsc_pose_ros.evaluation.evaluate import Evaluation


class VisibilityScore(NamedTuple):
    """The score of all joints of one visibility.

    Attributes:
        mean_error_m: the mean error of those that were estimated, NaN if none was.
        ap: the fraction that was estimated within the tolerance.
        mean_confidence: the mean confidence; it equals `ap` if it is calibrated.
        n: the number of joints.
    """

    mean_error_m: float
    ap: float
    mean_confidence: float
    n: int


def score_by_visibility(evaluation: Evaluation, tolerance: float) -> dict[str, VisibilityScore]:
    """Return a score for each visibility that labelled joints have, by its name.

    Args:
        evaluation: the errors.
        tolerance: metres.
    """
    scores = {}
    for visibility, name in VISIBILITIES.items():
        chosen = (evaluation.visibility == visibility) & ~np.isnan(evaluation.errors)
        if chosen.any():
            errors = evaluation.errors[chosen]
            estimated = errors[np.isfinite(errors)]
            scores[name] = VisibilityScore(
                float(estimated.mean()) if len(estimated) else float('nan'),
                float((errors <= tolerance).mean()),
                float(evaluation.confidence[chosen].mean()),
                len(errors),
            )
    return scores
