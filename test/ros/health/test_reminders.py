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

"""Messages about problems that last."""

from lsc_pose_ros.ros.health.reminders import LONGEST_TIME, Reminders


class Log:
    """Collects messages, and has the clock."""

    def __init__(self) -> None:
        self.time = 0.0
        self.lines: list[tuple[float, str]] = []
        self.reminders = Reminders(self, lambda: self.time)

    def info(self, message: str) -> None:
        raise AssertionError(message)

    error = info

    def warning(self, message: str) -> None:
        self.lines.append((self.time, message))

    def find(self, seconds: float, **problems: str) -> None:
        """Find the same problems every 5 s for some time."""
        end = self.time + seconds
        while self.time < end:
            self.reminders.update(problems)
            self.time += 5.0

    @property
    def times(self) -> list[float]:
        return [time for time, _ in self.lines]


def test_messages_about_a_problem_become_rare() -> None:
    log = Log()
    log.find(2000.0, depth='no depth')
    assert log.times == [0.0, 30.0, 90.0, 210.0, 450.0, 930.0, 1890.0]


def test_messages_never_stop() -> None:
    log = Log()
    log.find(12 * LONGEST_TIME, depth='no depth')
    steps = [later - earlier for earlier, later in zip(log.times, log.times[1:], strict=False)]
    assert steps == sorted(steps)
    assert max(steps) == LONGEST_TIME


def test_each_problem_has_its_own_times() -> None:
    log = Log()
    log.find(20.0, depth='no depth')
    log.find(40.0, depth='no depth', mask='no mask')
    assert log.lines == [
        (0.0, 'no depth'), (20.0, 'no mask'), (30.0, 'no depth'), (50.0, 'no mask'),
    ]  # fmt: skip


def test_problem_that_comes_and_goes_is_one_problem() -> None:
    log = Log()
    for _ in range(20):
        log.find(5.0, loss='lost')
        log.find(5.0)
    assert log.times == [0.0, 30.0, 90.0]


def test_problem_that_was_absent_for_a_minute_is_new() -> None:
    log = Log()
    log.find(200.0, loss='lost')
    log.find(60.0)
    log.lines.clear()
    log.find(60.0, loss='lost')
    assert log.times == [260.0, 290.0]


def test_problem_that_has_ended_is_new_when_it_returns() -> None:
    log = Log()
    log.find(10.0, depth='no depth')
    assert log.reminders.forget('depth')
    assert not log.reminders.forget('depth')
    log.find(5.0, depth='no depth')
    assert log.times == [0.0, 10.0]
