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

"""What a recording holds, found by reading all of it, its checksums included."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.bags.frames import FrameReader, open_recording
from lsc_pose_ros.bags.storage.reader import RecordingReader, read_messages
from lsc_pose_ros.bags.topics import Topics
from lsc_pose_ros.errors import InputError


class TopicReport(NamedTuple):
    """A topic: its name, its type, and how many messages were read of it."""

    name: str
    type_name: str
    messages: int


class RecordingReport(NamedTuple):
    """What was found.

    Attributes:
        path: the file or the bag folder.
        files: the files it consists of.
        size_bytes: what they take on disk.
        start_ns: when the earliest message was recorded, nanoseconds.
        duration_s: from there to the latest.
        messages: how many could be read.
        topics: all that have messages or are declared, by name.
        frames: complete frames: depth, camera info, mask.
        labelled_frames: frames with labelled skeletons.
        frame_topics: the topics that the frames are made of.
        warnings: what is wrong with it, a sentence each.
    """

    path: str
    files: list[str]
    size_bytes: int
    start_ns: int
    duration_s: float
    messages: int
    topics: list[TopicReport]
    frames: int
    labelled_frames: int
    frame_topics: dict[str, str]
    warnings: list[str]


class Inspection:
    """A reading of a whole recording; iterating it does the work, a step a frame or message.

    Attributes:
        total: how many steps there will be, None where the recording does not say.
    """

    def __init__(self, path: Path | str, topics: Topics, mask_background: int) -> None:
        """Open the recording.

        Raises:
            InputError: there is no recording.
        """
        self._frames: FrameReader | None = None
        self._raw: RecordingReader = read_messages(path)
        self._without_frames: list[str] = []
        self._count = 0
        self._labelled = 0
        try:
            self._frames = open_recording(path, topics, mask_background=mask_background)
        except InputError as error:
            self._without_frames = [f'it has no frames: {error}']

    @property
    def total(self) -> int | None:
        """How many steps the iteration will have, None where the recording does not say."""
        if self._frames is not None:
            return self._frames.count
        counts = [topic.count for topic in self._raw.topics.values()]
        return None if None in counts else sum(filter(None, counts))

    def __iter__(self) -> Iterator[object]:
        """Read the recording."""
        if self._frames is None:
            yield from self._raw
            return
        try:
            for frame in self._frames:
                self._count += 1
                self._labelled += frame.ground_truth is not None
                yield frame
        except InputError as error:
            # What the frames cannot use may be whole all the same: count it without them.
            self._frames = None
            self._without_frames = [f'frames can be read no further: {error}']
            yield from self._raw

    def report(self) -> RecordingReport:
        """Return what the iteration has found."""
        reader = self._frames or self._raw
        statistics, topics = reader.statistics, self._raw.topics
        used = self._frames.topics if self._frames is not None else Topics()
        return RecordingReport(
            path=str(self._raw.path),
            files=[str(path) for path in self._raw.files],
            size_bytes=self._raw.size,
            start_ns=statistics.start,
            duration_s=statistics.seconds,
            messages=statistics.messages,
            topics=[
                TopicReport(name, topics[name].type_name, statistics.counts.get(name, 0))
                for name in sorted(topics)
            ],
            frames=self._count,
            labelled_frames=self._labelled,
            frame_topics={name: topic for name, topic in used._asdict().items() if topic},
            warnings=[*reader.warnings, *self._without_frames],
        )
