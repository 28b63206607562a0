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


"""How steady the joints of a video are, on joints that are made to jitter, lag and change."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.video_scores import REST_SPEED, VideoFrame, score_video

FRAME_NS = 33_333_333
PERSON = {
    'l_shoulder': (0.2, 0, 2),
    'r_shoulder': (-0.2, 0, 2),
    'head': (0, -0.3, 2),
    'l_hand': (0.4, 0.3, 1.8),
}
NAMES = sorted(PERSON, key=JOINT_NUMBERS.__getitem__)
SHOULDERS = [NAMES.index('l_shoulder'), NAMES.index('r_shoulder')]


def skeletons(positions: np.ndarray, numbers: list[int]) -> Skeletons:
    return Skeletons(
        np.array(numbers, np.uint16),
        numbers_of(NAMES),
        positions.astype(np.float32),
        np.ones(positions.shape[:2], np.float32),
    )


def movement(count: int = 120) -> np.ndarray:
    """Return a person who rests for half of the time and then walks, shape (count, 4, 3)."""
    time = np.arange(count) / 30
    person = np.array([PERSON[name] for name in NAMES])
    path = np.where(time < 2, 0, np.sin(2.5 * (time - 2)) ** 2)
    return person + path[:, None, None] * [0.3, 0, 0.2]


def video(estimates: np.ndarray, truth: np.ndarray, numbers: list[int]) -> list[VideoFrame]:
    return [
        VideoFrame(n * FRAME_NS, skeletons(found[None], [number]), skeletons(true[None], [1]))
        for n, (found, true, number) in enumerate(zip(estimates, truth, numbers, strict=True))
    ]


def test_perfect_joints_have_no_faults() -> None:
    truth = movement()
    scores = score_video(video(truth, truth, [1] * 120), 0.1)
    assert scores.people == 120
    assert scores.mean_error_m == scores.jitter_m == scores.turned_round == 0
    assert scores.map == 1
    assert scores.jitter_at_rest_m < REST_SPEED / 30
    assert scores.turns == scores.id_switches_per_minute == 0
    assert scores.lag_frames == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize('lag', [1, 2, 4])
def test_late_joints_have_a_lag(lag: int) -> None:
    truth = movement()
    late = np.concatenate([truth[:1].repeat(lag, axis=0), truth[:-lag]])
    scores = score_video(video(late, truth, [1] * 120), 0.1)
    assert scores.lag_frames == pytest.approx(lag, abs=0.2)


def test_jitter_is_measured_at_rest() -> None:
    truth, rng = movement(), np.random.default_rng(0)
    noisy = truth + rng.normal(0, 0.01, truth.shape)
    scores = score_video(video(noisy, truth, [1] * 120), 0.1)
    # The length of the difference of two errors: chi with 3 degrees, 95 % below 2.795.
    assert scores.jitter_at_rest_m == pytest.approx(2.795 * 0.01 * np.sqrt(2), rel=0.1)
    assert scores.jitter_m == pytest.approx(2.795 * 0.01 * np.sqrt(2), rel=0.1)


def test_a_person_who_is_turned_round_is_noticed() -> None:
    truth = movement()
    turned = truth.copy()
    for frames in (slice(10, 13), slice(60, 61)):
        turned[frames, SHOULDERS] = truth[frames, SHOULDERS[::-1]]
    scores = score_video(video(turned, truth, [1] * 120), 0.1)
    assert scores.turned_round == pytest.approx(4 / 120)
    assert scores.turns == 4


def test_numbers_that_change_are_counted() -> None:
    truth = movement()
    numbers = [1] * 40 + [2] * 40 + [1] * 40
    scores = score_video(video(truth, truth, numbers), 0.1)
    assert scores.id_switches_per_minute == pytest.approx(2 * 60 / (119 / 30), rel=1e-3)


def test_people_who_are_not_found_have_no_joints_within_the_tolerance() -> None:
    truth = movement()
    estimates = truth.copy()
    estimates[:30] += 3
    scores = score_video(video(estimates, truth, [1] * 120), 0.1)
    assert scores.map == pytest.approx(0.75)
    assert scores.mean_error_m == 0
    assert scores.id_switches_per_minute == 0


def test_another_number_after_a_cut_is_no_change() -> None:
    truth = movement()
    truth[40:] += [0, 0, 2]  # other people
    numbers = [1] * 40 + [2] * 40 + [1] * 40
    scores = score_video(video(truth, truth, numbers), 0.1)
    assert scores.id_switches_per_minute == pytest.approx(60 / (119 / 30), rel=1e-3)
    # The movement over the cut is not one of a joint.
    still = np.repeat(movement()[:1], 3, axis=0)
    still[1:] += [0, 0, 2]
    assert score_video(video(still, still, [1, 2, 2]), 0.1).jitter_m == 0


@pytest.mark.parametrize(('absent', 'changes'), [(20, 1), (40, 0)])
def test_another_number_after_a_long_absence_is_no_change(absent: int, changes: int) -> None:
    truth = movement()
    estimates = truth.copy()
    estimates[40 : 40 + absent] += 3
    numbers = [1] * 40 + [2] * 80
    scores = score_video(video(estimates, truth, numbers), 0.1)
    assert scores.id_switches_per_minute == pytest.approx(changes * 60 / (119 / 30), rel=1e-3)


def test_a_body_is_compared_with_one_person() -> None:
    """Two people stand close together, and only one of them is found in the second frame."""
    first = movement()[0]
    second = first + np.array([0.3, 0, 0])
    both = skeletons(np.array([first, second]), [1, 2])
    alone = skeletons(first[None], [1])
    frames = [VideoFrame(0, both, both), VideoFrame(FRAME_NS, alone, both)]
    scores = score_video(frames, 0.1)
    assert scores.people == 4
    assert scores.map == pytest.approx(0.75)
    assert scores.id_switches_per_minute == 0
