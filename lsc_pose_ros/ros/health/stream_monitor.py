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

"""Follows the counters of the stream: logs what is wrong, and when messages arrive again."""

import time
from collections.abc import Callable, Mapping

from lsc_pose_ros.ros.health.reminders import Reminders
from lsc_pose_ros.ros.health.stream_warnings import (
    Counters,
    Delivery,
    StreamContext,
    TopicNames,
    duration,
    stream_warnings,
)
from lsc_pose_ros.ros.health.throttled_log import Logger


class StreamMonitor:
    """Checks the stream from time to time, and logs its problems."""

    def __init__(
        self,
        logger: Logger,
        topics: TopicNames,
        profile: str,
        counters: Callable[[], Counters],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin to measure how long nothing is received.

        Args:
            logger: receives the messages.
            topics: the subscribed topics.
            profile: the path of the Fast DDS profile.
            counters: returns the current counters.
            now: the clock, seconds.
        """
        self._logger = logger
        self._topics = topics
        self._profile = profile
        self._counters = counters
        self._now = now
        self._reminders = Reminders(logger, now)
        self._last_counters = counters()
        self._last_received = dict.fromkeys(topics.subscribed, now())

    def check(
        self,
        needed: TopicNames,
        publishers: Mapping[str, int],
        delivery: Mapping[str, Delivery],
    ) -> None:
        """Log what went wrong since the last check, and what is right again.

        Args:
            needed: the topics without which no frame is complete.
            publishers: how many publishers each topic has.
            delivery: how the messages of each topic are delivered.
        """
        before, self._last_counters = self._last_counters, self._counters()
        silence = self._update_silence(self._last_counters.since(before))
        context = StreamContext(needed, publishers, self._profile, silence, delivery)
        self._reminders.update(stream_warnings(before, self._last_counters, context))

    def _update_silence(self, increase: Counters) -> dict[str, float]:
        """Return how long nothing has been received on each topic, seconds."""
        now, topics = self._now(), self._topics
        received = {
            topics.depth: ('no depth', increase.depth),
            topics.camera_info: ('no camera info', increase.camera_infos),
            topics.mask: ('no mask', increase.masks),
        }
        for topic in topics.subscribed:
            kind, count = received[topic]
            if not count:
                continue
            if self._reminders.forget(kind):
                silence = duration(now - self._last_received[topic])
                text = f'messages arrive on {topic} after {silence} without any'
                self._logger.info(text)
            self._last_received[topic] = now
        return {topic: now - last for topic, last in self._last_received.items()}
