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

"""Summarises a recording by reading all of it, including its checksums."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.bags.frames import FrameReader, open_recording
from lsc_pose_ros.bags.storage.reader import RecordingReader, read_messages
from lsc_pose_ros.bags.topics import Topics
from lsc_pose_ros.data_types.skeletons import known_bodies
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.settings.table import MASK, FrameSettings


class TopicReport(NamedTuple):
    """A topic, and the number of its messages that were read."""

    name: str
    type_name: str
    messages: int


class RecordingReport(NamedTuple):
    """The contents of a recording.

    Attributes:
        path: the file or the bag folder.
        files: its files.
        size_bytes: the size of the files.
        start_ns: the earliest log time, nanoseconds.
        duration_s: the time from the earliest to the latest message, seconds.
        messages: the number of messages that can be read.
        topics: all topics that are declared or have messages, sorted by name.
        frames: the number of complete frames: depth image, camera info, mask if there is one.
        labelled_frames: the number of frames with ground truth of a body: a joint that is known.
        frame_topics: the topics of the frames, by their role.
        images: the size, encoding and frame of the depth images, each kind once.
        camera: how the camera infos were read; '' without frames.
        camera_roll: which roll of the camera was taken, and why; '' without frames.
        warnings: a sentence for each problem.
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
    images: list[str]
    camera: str
    camera_roll: str
    warnings: list[str]


class Inspection:
    """Reads a whole recording while it is iterated; a step is a frame or a message."""

    def __init__(self, path: Path | str, topics: Topics, settings: FrameSettings) -> None:
        """Open the recording.

        Raises:
            InputError: there is no recording.
        """
        self._frames: FrameReader | None = None
        self._messages: RecordingReader = read_messages(path)
        self._without_frames: list[str] = []
        self._frame_count = 0
        self._labelled = 0
        try:
            if settings.reads_masks:  # frames are counted, not segmented
                settings = replace(settings, segmentation=MASK)
            self._frames = open_recording(path, topics, settings=settings, need_mask=False)
        except InputError as error:
            self._without_frames = [f'it has no frames: {error}']

    @property
    def total(self) -> int | None:
        """The number of steps of the iteration, None if it is unknown."""
        if self._frames is not None:
            return self._frames.count
        counts = [topic.count for topic in self._messages.topics.values()]
        return None if None in counts else sum(filter(None, counts))

    def __iter__(self) -> Iterator[object]:
        """Read the recording."""
        if self._frames is None:
            yield from self._messages
            return
        try:
            for frame in self._frames:
                self._frame_count += 1
                truth = frame.ground_truth
                self._labelled += truth is not None and known_bodies(truth) > 0
                yield frame
        except InputError as error:
            # The messages may be intact although no frame can be made of them: count messages.
            self._frames = None
            self._without_frames = [f'the reading of frames stopped: {error}']
            yield from self._messages

    def report(self) -> RecordingReport:
        """Return the contents, after the iteration."""
        reader = self._frames or self._messages
        statistics, topics = reader.statistics, self._messages.topics
        used = self._frames.topics if self._frames is not None else Topics()
        return RecordingReport(
            path=str(self._messages.path),
            files=[str(path) for path in self._messages.files],
            size_bytes=self._messages.size,
            start_ns=statistics.start,
            duration_s=statistics.seconds,
            messages=statistics.messages,
            topics=[
                TopicReport(name, topics[name].type_name, statistics.counts.get(name, 0))
                for name in sorted(topics)
            ],
            frames=self._frame_count,
            labelled_frames=self._labelled,
            frame_topics={name: topic for name, topic in used._asdict().items() if topic},
            images=list(self._frames.images) if self._frames is not None else [],
            camera=self._frames.camera if self._frames is not None else '',
            camera_roll=self._frames.roll if self._frames is not None else '',
            warnings=[*reader.warnings, *self._without_frames],
        )
