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

"""Copies the messages of frames from a recording into another."""

import struct

from lsc_pose_ros.bags import FrameReader, RecordingWriter, SerializedMessage, read_messages

_LITTLE_ENDIAN = 1


class MessageCopier:
    """Copies recorded messages in step with the frames, in bounded memory."""

    def __init__(
        self, frames: FrameReader, writer: RecordingWriter, topics: frozenset[str]
    ) -> None:
        """Copy `topics` of the recording of `frames`."""
        self._writer = writer
        self._depth_topic = frames.topics.depth
        self._topics = topics
        self._messages = iter(read_messages(frames.path))
        self._log_times: dict[int, int] = {}

    def copy_up_to(self, stamp: int) -> int:
        """Copy messages up to the depth image with `stamp`; return its log time, nanoseconds."""
        while stamp not in self._log_times:
            message = next(self._messages, None)
            if message is None:
                return stamp
            self._copy(message)
        log_time = self._log_times.pop(stamp)
        # Frames come in order: an older image has no mask, and its log time is not needed.
        for older in [each for each in self._log_times if each < stamp]:
            del self._log_times[older]
        return log_time

    def copy_rest(self) -> None:
        """Copy the messages after the last frame."""
        for message in self._messages:
            self._copy(message)

    def _copy(self, message: SerializedMessage) -> None:
        if message.topic not in self._topics:
            return
        self._writer.write(message.topic, message.type_name, message.log_time, message.data)
        if message.topic == self._depth_topic:
            self._log_times[_stamp(message.data)] = message.log_time


def _stamp(data: bytes) -> int:
    """Return the stamp of a serialized message that begins with a header, nanoseconds."""
    order = '<' if data[1] & _LITTLE_ENDIAN else '>'
    seconds, nanoseconds = struct.unpack_from(f'{order}iI', data, 4)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)
