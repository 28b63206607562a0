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

"""The times of frames and stages, and their summary."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.benchmark import (
    BLOCK,
    DECODE,
    TIMED,
    WHOLE,
    FrameTimes,
    summarise_times,
    time_frames,
    time_stages,
    warm_up,
)
from lsc_pose_ros.evaluation.encoded_frame import decode_frame, encode_frame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.stages import STAGE_NAMES


@pytest.fixture(scope='module')
def estimator(small_model):
    return Estimator(small_model)


@pytest.fixture(scope='module')
def encoded(people):
    """One frame of each of the eight people."""
    return [encode_frame(frame) for frame in people[10::30]]


def test_each_frame_has_the_times_of_all_stages_and_of_the_whole(estimator, encoded):
    frames = warm_up(estimator, encoded)
    assert frames == encoded
    times = list(time_frames(estimator, frames * 2))
    assert len(times) == 2 * len(encoded) > BLOCK
    for frame, number in zip(times, range(len(times)), strict=True):
        assert list(frame.seconds) == list(TIMED) == [DECODE, *STAGE_NAMES, WHOLE]
        assert min(frame.seconds.values()) > 0
        depth, labels = decode_frame((frames * 2)[number])
        expected = estimator.estimate(depth, labels, frames[0].camera)
        np.testing.assert_array_equal(frame.positions, expected.positions)


def test_stages_run_as_often_as_there_are_bodies(estimator, people, monkeypatch):
    frame = people[5]
    labels = np.where(frame.labels >= 0, frame.labels, NO_BODY).astype(np.int32)
    labels[:, labels.shape[1] // 2 :] *= 2  # the right half is another body
    labels[labels < 0] = NO_BODY
    called = []

    class CountingClock:
        def __init__(self, names):
            self.seconds = dict.fromkeys(names, 0.0)

        def __call__(self, stage):
            called.append(stage)

    monkeypatch.setattr('lsc_pose_ros.evaluation.benchmark.StageClock', CountingClock)
    time_stages(estimator, encode_frame(frame._replace(labels=labels)))
    bodies = len(set(np.unique(labels).tolist()) - {NO_BODY})
    assert bodies == 2
    assert called == [DECODE, *STAGE_NAMES * bodies]


def test_frames_with_nobody_are_left_out_and_a_benchmark_of_nobody_is_refused(
    estimator, people, encoded
):
    empty = encode_frame(people[0]._replace(labels=np.full_like(people[0].labels, NO_BODY)))
    assert warm_up(estimator, [empty, *encoded[:2], empty]) == encoded[:2]
    with pytest.raises(InputError, match='too little of a person is visible in each of 2 frames'):
        warm_up(estimator, [empty, empty])


def test_summary_has_the_median_and_the_95th_percentile():
    times = [
        FrameTimes(
            {stage: 0.001 * n * (k + 1) for k, stage in enumerate(TIMED)},
            np.zeros((1, 1, 3), np.float32),
        )
        for n in range(21)
    ]
    summaries = summarise_times(times)
    assert list(summaries) == list(TIMED)
    for k, summary in enumerate(summaries.values()):
        assert summary.ms_p50 == pytest.approx(10 * (k + 1))
        assert summary.ms_p95 == pytest.approx(19 * (k + 1))
