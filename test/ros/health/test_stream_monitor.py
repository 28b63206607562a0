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

"""What the log says while a stream stops and begins."""

from lsc_pose_ros.ros.health.stream_monitor import StreamMonitor
from lsc_pose_ros.ros.health.stream_warnings import Counters, TopicNames


class Stream:
    """Counters and a clock, and the monitor that follows them."""

    def __init__(self) -> None:
        self.time = 0.0
        self.counters = Counters()
        self.lines: list[str] = []
        topics = self.topics = TopicNames('/depth', '/info', '/mask')
        self.monitor = StreamMonitor(
            self, topics, '/profile.xml', lambda: self.counters, lambda: self.time
        )

    def info(self, message: str) -> None:
        self.lines.append(f'info: {message}')

    def warning(self, message: str) -> None:
        self.lines.append(message)

    def error(self, message: str) -> None:
        raise AssertionError(message)

    def run(self, seconds: float, **rates: int) -> list[str]:
        """Let counters increase every 5 s for some time; return what was logged."""
        self.lines.clear()
        end = self.time + seconds
        while self.time < end:
            self.time += 5.0
            changed = {name: getattr(self.counters, name) + rate for name, rate in rates.items()}
            self.counters = self.counters._replace(**changed)
            self.monitor.check(self.topics, {}, {})
        return list(self.lines)


GOOD = {'depth': 150, 'masks': 150, 'camera_infos': 150, 'pairs': 150}


def test_good_stream_needs_no_message() -> None:
    assert Stream().run(600.0, **GOOD) == []


def test_silence_is_told_with_its_duration_less_and_less_often() -> None:
    stream = Stream()
    lines = stream.run(700.0)
    depth = [line.partition(';')[0] for line in lines if '/depth ' in line]
    assert depth == [
        f'nothing received on /depth for {time} (no publishers)'
        for time in ('5 s', '35 s', '95 s', '4 min', '8 min')
    ]
    assert len(lines) == 3 * len(depth)


def test_messages_that_arrive_after_a_warning_are_told() -> None:
    stream = Stream()
    stream.run(60.0)
    assert stream.run(60.0, **GOOD) == [
        'info: messages arrive on /depth after 65 s without any',
        'info: messages arrive on /info after 65 s without any',
        'info: messages arrive on /mask after 65 s without any',
    ]


def test_topic_that_falls_silent_again_is_told_at_once() -> None:
    stream = Stream()
    stream.run(60.0)
    stream.run(5.0, **GOOD)
    (line,) = stream.run(20.0, **(GOOD | {'masks': 0}))
    assert line.startswith('nothing received on /mask for 5 s (no publishers)')
    (line,) = stream.run(5.0, **GOOD)
    assert line == 'info: messages arrive on /mask after 25 s without any'


def test_camera_info_that_came_once_is_enough() -> None:
    stream = Stream()
    stream.run(5.0, **GOOD)
    assert stream.run(600.0, **(GOOD | {'camera_infos': 0})) == []
