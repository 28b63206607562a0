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

"""Constant offsets between a model's joints and those of other labels.

Each data set defines its joints at other positions in the body: the hips of a Kinect are far above
those of a skeleton that was fitted to markers. One constant offset for each joint removes this
difference and nothing else; the remaining error is that of the model.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.evaluation.evaluate import Evaluation


def fit_offsets(evaluation: Evaluation) -> NDArray[np.float32]:
    """Return the median over all people of ground truth minus estimate, metres, shape (J, 3).

    Each axis of the camera frame has its own median, which single large errors do not change. The
    offset is NaN for a joint that is nowhere both labelled and estimated.
    """
    differences = evaluation.differences
    offsets = np.full(differences.shape[1:], np.nan, np.float32)
    for j in range(differences.shape[1]):
        known = differences[:, j][~np.isnan(differences[:, j]).any(axis=1)]
        if len(known):
            offsets[j] = np.median(known, axis=0)
    return offsets


def apply_offsets(evaluation: Evaluation, offsets: NDArray[np.float32]) -> Evaluation:
    """Return `evaluation` with `offsets` added to each estimate.

    Args:
        evaluation: the evaluation of the unchanged estimates.
        offsets: metres, in the camera frame, shape (J, 3); NaN leaves a joint unchanged.
    """
    differences = evaluation.differences - np.nan_to_num(offsets)
    errors: NDArray[np.float32] = np.linalg.norm(differences, axis=-1).astype(np.float32)
    # Errors stay NaN without a label and infinite without an estimate.
    estimated = np.isfinite(evaluation.errors)
    return evaluation._replace(
        errors=np.where(estimated, errors, evaluation.errors), differences=differences
    )
