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

"""Log messages that are limited to one of each kind in a period."""

from collections.abc import Callable

from lsc_pose_ros.errors import LONGEST_TEXT, InputError
from lsc_pose_ros.ros.health.throttled_log import ThrottledLog, kind_of


class Log:
    def __init__(self) -> None:
        self.lines: list[tuple[str, str]] = []

    def info(self, message: str) -> None:
        self.lines.append(('info', message))

    def warning(self, message: str) -> None:
        self.lines.append(('warning', message))

    def error(self, message: str) -> None:
        self.lines.append(('error', message))


def test_each_kind_is_logged_once_in_a_period() -> None:
    log, time = Log(), [0.0]
    throttled = ThrottledLog(log, 5.0, lambda: time[0])
    for step in range(11):
        time[0] = step * 0.5
        throttled.error('mask', f'bad mask {step}')
        throttled.warning('depth', f'bad depth {step}')
    assert log.lines == [
        ('error', 'bad mask 0'),
        ('warning', 'bad depth 0'),
        ('error', 'bad mask 10 (9 more like this since the last report)'),
        ('warning', 'bad depth 10 (9 more like this since the last report)'),
    ]


def test_problem_that_returns_later_is_logged_at_once() -> None:
    log, time = Log(), [0.0]
    throttled = ThrottledLog(log, 5.0, lambda: time[0])
    throttled.error('mask', 'first')
    time[0] = 100.0
    throttled.error('mask', 'second')
    assert [line[1] for line in log.lines] == ['first', 'second']


def test_old_kinds_are_forgotten() -> None:
    log, time = Log(), [0.0]
    throttled = ThrottledLog(log, 5.0, lambda: time[0])
    for step in range(20000):
        time[0] = step * 0.5
        throttled.error(f'{step} bytes', 'broken')
    assert len(log.lines) == 20000
    assert len(throttled._last) < 1300


def test_long_text_is_cut() -> None:
    log = Log()
    ThrottledLog(log).error('mask', f'begin {"x" * 1_000_000} end')
    ((_, text),) = log.lines
    assert len(text) < LONGEST_TEXT + 100
    assert text.startswith('begin x')
    assert text.endswith('x end')
    assert '[... 998010 characters ...]' in text


def decode(text: str | None) -> None:
    try:
        float(text)
    except ValueError as error:
        msg = f'wrong: {text}'
        raise InputError(msg) from error


def decode_mask(text: str | None) -> None:
    decode(text)


def kind_in(act: Callable[[str | None], None], text: str | None) -> str:
    try:
        act(text)
    except (InputError, TypeError) as error:
        return kind_of(error)
    raise AssertionError


def test_kind_is_the_place_and_not_the_text() -> None:
    assert kind_in(decode, 'a') == kind_in(decode, 'b')
    assert kind_in(decode, 'a') != kind_in(decode_mask, 'a')
    assert kind_in(decode, 'a') != kind_in(decode, None)
