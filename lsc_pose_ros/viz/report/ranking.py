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

"""The best and the worst frames of an evaluation."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.evaluation.evaluate import Evaluation


class Ranking(NamedTuple):
    """Frame numbers as in Evaluation; the best or the worst comes first."""

    best: list[int]
    worst: list[int]


def rank_frames(evaluation: Evaluation, count: int) -> Ranking:
    """Return the `count` frames with the smallest and those with the largest error.

    A frame's error is the mean over its labelled joints. A frame with joints that were not
    estimated is worse than any other, and the more of them, the worse. No frame is in both lists.
    """
    frames, keys = _frame_errors(evaluation)
    order = frames[np.lexsort((frames, keys[:, 1], keys[:, 0]))].tolist()
    best = order[: min(count, (len(order) + 1) // 2)]
    worst = order[::-1][: min(count, len(order) - len(best))]
    return Ranking(best, worst)


def _frame_errors(evaluation: Evaluation) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the labelled frames, (n,), and the missing joints and mean error of each, (n, 2).

    The mean is over the joints that were estimated.
    """
    people = ~np.isnan(evaluation.errors).all(axis=1)
    frames = np.unique(evaluation.frames[people])
    keys = np.zeros((len(frames), 2))
    for row, frame in enumerate(frames):
        errors = evaluation.errors[evaluation.frames == frame]
        estimated = errors[np.isfinite(errors)]
        keys[row] = np.isinf(errors).sum(), estimated.mean() if len(estimated) else np.inf
    return frames, keys
