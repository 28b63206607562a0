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

"""When a recorded message is due."""

import pytest

from lsc_pose_ros.ros.playback.pacing import Pacer

START = 1_700_000_000_000_000_000
SECOND = 1_000_000_000


class Time:
    """A clock that only sleeping moves."""

    def __init__(self) -> None:
        self.now = 50.0
        self.longest = 0.0

    def sleep(self, seconds: float) -> None:
        self.now += seconds
        self.longest = max(self.longest, seconds)


@pytest.fixture
def time() -> Time:
    return Time()


def pacer_at(rate: float, time: Time) -> Pacer:
    return Pacer(rate, lambda: time.now, time.sleep)


@pytest.mark.parametrize('rate', [0.5, 1.0, 4.0])
def test_messages_are_due_as_recorded(rate: float, time: Time) -> None:
    pacer = pacer_at(rate, time)
    for seconds in (0, 1, 1, 3):
        list(pacer.wait_until(START + seconds * SECOND))
        assert time.now == pytest.approx(50 + seconds / rate)


def test_lateness_does_not_add_up(time: Time) -> None:
    pacer = pacer_at(1.0, time)
    for number in range(100):
        list(pacer.wait_until(START + number * SECOND // 10))
        time.now += 0.05  # publishing takes time
    list(pacer.wait_until(START + 10 * SECOND))
    assert time.now == pytest.approx(60)


def test_message_older_than_the_one_before_is_due_at_once(time: Time) -> None:
    pacer = pacer_at(1.0, time)
    list(pacer.wait_until(START + SECOND))
    assert list(pacer.wait_until(START)) == [START]
    assert time.now == 50


def test_recorded_time_is_told_while_waiting(time: Time) -> None:
    pacer = pacer_at(2.0, time)
    list(pacer.wait_until(START))
    moments = list(pacer.wait_until(START + SECOND))
    assert moments == sorted(moments)
    assert START <= moments[0] <= START + SECOND // 20
    assert moments[-1] == START + SECOND
    assert len(moments) >= 25
    assert time.longest <= 0.02
