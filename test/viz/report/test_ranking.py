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

import numpy as np

from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.evaluation.evaluate import Evaluation
from lsc_pose_ros.viz.report.ranking import rank_frames

NAN, INF = float('nan'), float('inf')


def evaluation(frames: list[int], errors: list[list[float]]) -> Evaluation:
    return Evaluation(
        np.array([0, 1], np.uint16),
        np.array(errors, np.float32),
        np.array(frames),
        np.ones(len(frames), np.uint16),
        np.full(max(frames) + 1, 0.01),
        np.ones((len(frames), 2), np.float32),
        np.full((len(frames), 2, 3), NAN, np.float32),
        np.full((len(frames), 2), UNKNOWN, np.uint8),
    )


def test_frames_are_ranked_by_their_mean_error() -> None:
    ranking = rank_frames(evaluation([0, 1, 2, 3], [[0.3, 0.1], [0.1, NAN], [0.9, 0], [0, 0]]), 2)
    assert ranking.best == [3, 1]
    assert ranking.worst == [2, 0]


def test_joints_without_an_estimate_are_worse_than_any_error() -> None:
    ranking = rank_frames(
        evaluation([0, 1, 2, 3], [[9, 9], [0.1, INF], [INF, INF], [0.1, 0.1]]), 3
    )
    assert ranking.worst == [2, 1]
    assert ranking.best == [3, 0]


def test_people_of_one_frame_count_together_and_unlabelled_frames_not_at_all() -> None:
    errors = [[0.1, 0.1], [0.7, 0.7], [0.2, 0.2], [NAN, NAN]]
    assert rank_frames(evaluation([0, 0, 2, 5], errors), 1) == ([2], [0])


def test_no_frame_is_among_the_best_and_the_worst() -> None:
    assert rank_frames(evaluation([0, 1, 2], [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]]), 9) == (
        [0, 1],
        [2],
    )
    assert rank_frames(evaluation([4], [[0.1, 0.1]]), 9) == ([4], [])


def test_equal_frames_keep_their_order() -> None:
    assert rank_frames(evaluation([3, 1, 2, 0], [[0.1, 0.1]] * 4), 2).best == [0, 1]
