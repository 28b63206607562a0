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

"""Reads the frames of a recording."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from lsc_pose_ros.bags.serialization.deserialize import (
    DamagedMessageError,
    read_camera_info,
    read_compressed_image,
    read_image,
    read_skeletons,
    read_transforms,
)
from lsc_pose_ros.bags.storage.reader import RecordingReader
from lsc_pose_ros.bags.storage.serialized_messages import ReadStatistics, SerializedMessage
from lsc_pose_ros.bags.topics import RecordedTopics, Topics, Transports, find_topics
from lsc_pose_ros.camera.transform_tree import TransformTree
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.image_pixels import AnyImage, describe_image
from lsc_pose_ros.messages.parse import StampedCamera, StampedImage
from lsc_pose_ros.messages.rectification import ImageSource
from lsc_pose_ros.messages.stamps import NANOSECONDS
from lsc_pose_ros.messages.type_names import IMAGE, TF_MESSAGE
from lsc_pose_ros.settings.setting import checked_settings
from lsc_pose_ros.settings.table import MASK, FrameSettings
from lsc_pose_ros.synchronization.frame_maker import FrameMaker
from lsc_pose_ros.synchronization.synchronizer import (
    SynchronizedFrame,
    Synchronizer,
    SynchronizerSettings,
)

# So many different reasons are told at most.
_MOST_REASONS = 5

# How many messages are read at most to find the encodings of the images.
_MOST_PEEKED = 5000

# The end of the names of topics with static transforms.
_STATIC = 'tf_static'

_MOST_KINDS_OF_IMAGES = 5

_FIND_ALL = Topics()
_DEFAULT_SETTINGS = FrameSettings()

_Synchronizer: TypeAlias = Synchronizer[AnyImage, AnyImage, StampedCamera, Skeletons]
_Parts: TypeAlias = SynchronizedFrame[AnyImage, AnyImage, StampedCamera, Skeletons]


class FrameReader:
    """The frames of a recording; each iteration reads the recording again in bounded memory.

    Attributes:
        path: the file or the bag folder.
        topics: the topics of the frames; '' for one that the recording does not have.
        warnings: a sentence for each problem of the recording. The list grows during an iteration
            and is cleared by the next one.
        camera: how the last camera info was read: which matrix was taken, and why.
        roll: which roll of the camera was taken, and why.
        bodies: how the bodies of the last frame were found.
        images: what the depth images are: size, encoding and frame, each kind once.
    """

    def __init__(self, messages: RecordingReader, topics: Topics, settings: FrameSettings) -> None:
        """Read frames from `messages`; use `open_recording` to create one."""
        self._messages = messages
        self._settings = settings
        self.path = messages.path
        self.topics = topics
        self.warnings = messages.warnings
        self.camera = self.roll = self.bodies = ''
        self.images: list[str] = []

    @property
    def count(self) -> int | None:
        """The number of depth images according to the recording, None if it is unknown."""
        return self._messages.topics[self.topics.depth].count

    @property
    def transform_topics(self) -> frozenset[str]:
        """The topics of transforms, empty if the roll of the camera does not depend on them."""
        if self._settings.roll is not None:
            return frozenset()
        topics = self._messages.topics
        return frozenset(name for name, each in topics.items() if each.type_name == TF_MESSAGE)

    def _note_image(self, image: AnyImage, frame: Frame) -> None:
        """Remember what the depth image of a frame, which is upright, is."""
        shape = frame.depth.shape
        text = describe_image(image, shape[::-1] if frame.roll % 180 else shape)
        if text not in self.images and len(self.images) < _MOST_KINDS_OF_IMAGES:
            self.images.append(text)

    @property
    def statistics(self) -> ReadStatistics:
        """What the current or last iteration has read, of all topics."""
        return self._messages.statistics

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in the order of their messages.

        Raises:
            InputError: a message cannot be used, or there is no complete frame.
        """
        maker = FrameMaker(self.topics, self._settings)
        reading = _Reading(self._messages, self.topics, self._settings)
        reading.use_transforms(self.transform_topics, maker.roll_finder.tree)
        usable, unusable = 0, reading.unusable
        for parts in reading.synchronized():
            try:
                frame = maker.make(parts.depth, parts.mask, parts.camera_info, parts.ground_truth)
            except InputError as error:
                unusable.add(str(error))
                continue
            self.camera, self.roll = maker.camera, maker.roll_finder.choice
            self.bodies = maker.bodies
            self._note_image(parts.depth, frame)
            usable += 1
            yield frame
        self.warnings.extend([*maker.warnings, *reading.warnings()])
        if usable == 0 and not unusable.total:
            msg = f'{self.path}: no frame could be read: {reading.reason_for_no_frame()}'
            raise InputError('; '.join([msg, *self.warnings]))
        if unusable.total > usable:
            msg = (
                f'{self.path}: {unusable.total} of {usable + unusable.total} frames cannot be '
                f'used: topic {unusable.first}'
            )
            raise InputError(msg)
        self.warnings.extend(unusable.warnings())


class _Unusable:
    """Counts what cannot be used, by the reason."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()

    @property
    def total(self) -> int:
        """How many messages or frames cannot be used."""
        return self._counts.total()

    @property
    def first(self) -> str:
        """The first reason."""
        return next(iter(self._counts))

    def add(self, reason: str) -> None:
        """Count something that cannot be used; `reason` begins with its topic."""
        self._counts[reason] += 1

    def warnings(self) -> list[str]:
        """Return a sentence for each of the most frequent reasons."""
        return [
            f'{count} of the frames {"were" if count > 1 else "was"} left out: {reason}'
            for reason, count in self._counts.most_common(_MOST_REASONS)
        ]


class _Reading:
    """One pass through a recording."""

    def __init__(
        self,
        messages: RecordingReader,
        topics: Topics,
        settings: FrameSettings,
    ) -> None:
        self._messages = messages
        self._source = ImageSource(topics.depth, settings.rectified)
        self._topics = topics
        self._damaged: Counter[str] = Counter()
        self._counts: Counter[str] = Counter()
        self._synchronizer: _Synchronizer = Synchronizer(
            SynchronizerSettings(
                slop_ns=round(settings.sync_slop * NANOSECONDS),
                capacity=settings.sync_queue,
                with_masks=bool(topics.mask),
                with_ground_truth=bool(topics.ground_truth),
            ),
            self._find_first_info,
        )
        self.unusable = _Unusable()
        self._transform_topics: frozenset[str] = frozenset()
        self._tree = TransformTree()

    def use_transforms(self, topics: frozenset[str], tree: TransformTree) -> None:
        """Add the transforms of `topics` to `tree`."""
        self._transform_topics, self._tree = topics, tree

    def synchronized(self) -> Iterator[_Parts]:
        """Yield the parts of each frame."""
        frame_topics = frozenset(filter(None, self._topics))
        transform_topics = self._transform_topics
        # Static transforms hold for the whole recording, wherever they are in it.
        static = {name for name in transform_topics if name.endswith(_STATIC)}
        for message in self._messages.select(static) if static else ():
            self._add_transforms(message)
        for message in self._messages:
            if message.topic in frame_topics:
                yield from self._add(message)
            elif message.topic in transform_topics:
                self._add_transforms(message)
        yield from self._synchronizer.finish()

    def warnings(self) -> list[str]:
        """Return a sentence for each kind of messages that were left out."""
        dropped, topics = self._synchronizer.dropped, self._topics
        damaged = [
            f'{count} damaged messages of {topic} were left out'
            for topic, count in self._damaged.items()
        ]
        return [
            *damaged,
            *_left_out(dropped.unmatched_depth, topics.depth, f'have no mask in {topics.mask}'),
            *_left_out(dropped.unmatched_masks, topics.mask, f'have no image in {topics.depth}'),
            *_left_out(dropped.duplicates, 'the images', 'repeat the stamp of another'),
            *_left_out(
                self._synchronizer.without_camera_info,
                topics.depth,
                f'came long before the first camera info of {topics.camera_info}',
            ),
        ]

    def reason_for_no_frame(self) -> str:
        """Return why there is no frame."""
        topics = self._topics
        missing = [
            topic
            for topic in (topics.depth, topics.camera_info, topics.mask)
            if topic and not self._counts[topic]
        ]
        if missing:
            return f'there is no usable message of {", ".join(missing)}'
        if self._synchronizer.without_camera_info:
            return f'no camera info of {topics.camera_info} came in time'
        return f'no mask of {topics.mask} has the stamp of a depth image'

    def _add_transforms(self, message: SerializedMessage) -> None:
        with suppress(DamagedMessageError):
            for transform in read_transforms(message.data):
                self._tree.add(transform)

    def _find_first_info(self) -> StampedCamera | None:
        """Return the first usable camera info of the recording."""
        for message in self._messages.select({self._topics.camera_info}):
            try:
                return read_camera_info(message.data, self._source)
            except InputError:  # noqa: PERF203
                continue
        return None

    def _add(self, message: SerializedMessage) -> list[_Parts]:
        try:
            frames = self._dispatch(message)
        except DamagedMessageError:
            self._damaged[message.topic] += 1
            return []
        except InputError as error:
            self.unusable.add(f'{message.topic}: {error}')
            return []
        self._counts[message.topic] += 1
        return frames

    def _dispatch(self, message: SerializedMessage) -> list[_Parts]:
        topics = self._topics
        if message.topic == topics.depth:
            depth = _read_any_image(message)
            return self._synchronizer.add_depth(depth.stamp, depth)
        if message.topic == topics.mask:
            mask = _read_any_image(message)
            return self._synchronizer.add_mask(mask.stamp, mask)
        if message.topic == topics.camera_info:
            camera = read_camera_info(message.data, self._source)
            return self._synchronizer.add_camera_info(camera.stamp, camera)
        ground_truth = read_skeletons(message.data)
        return self._synchronizer.add_ground_truth(ground_truth.stamp, ground_truth.skeletons)


def open_recording(
    path: Path | str,
    topics: Topics = _FIND_ALL,
    *,
    settings: FrameSettings = _DEFAULT_SETTINGS,
    need_mask: bool = True,
) -> FrameReader:
    """Open a recording for reading its frames.

    Args:
        path: an .mcap or .db3 file (compressed as .zstd or not), or a bag folder.
        topics: the topics' names; each '' is found by type and name.
        settings: how frames are made from messages. Masks are read if the segmentation is `mask`,
            or `auto` and the recording has masks.
        need_mask: if False, a recording without masks gives frames whose labels are all NO_BODY
            with the segmentation `mask`.

    Raises:
        InputError: there is no recording, a topic is missing or ambiguous, or an argument or
            a setting cannot be used.
    """
    _check_arguments(path, topics, settings)
    settings = checked_settings(settings)
    messages = RecordingReader(path)
    recorded = RecordedTopics(
        str(messages.path), messages.topics, lambda names: _encodings(messages, names)
    )
    if not any(topic.count != 0 for topic in messages.topics.values()):
        list(messages)  # for its warnings
        raise InputError('; '.join([f'{path}: the recording has no messages', *messages.warnings]))
    with_masks = settings.reads_masks
    transports = Transports(settings.depth_transport, settings.mask_transport)
    must_have = need_mask and settings.segmentation == MASK
    found = find_topics(topics, recorded, transports, with_masks=with_masks, need_mask=must_have)
    if found.mask:
        settings = replace(settings, segmentation=MASK)
    return FrameReader(messages, found, settings)


def _check_arguments(path: object, topics: object, settings: object) -> None:
    if not isinstance(path, (str, os.PathLike)):
        msg = f'the recording must be a path, but is of type {type(path).__name__}'
        raise InputError(msg)
    if not isinstance(topics, Topics):
        msg = (
            f'topics is of type {type(topics).__name__}, but must be lsc_pose_ros.Topics, '
            "for example Topics(depth='/camera/depth')"
        )
        raise InputError(msg)
    if not isinstance(settings, FrameSettings):
        msg = (
            f'settings is of type {type(settings).__name__}, but must be '
            'lsc_pose_ros.FrameSettings, for example FrameSettings(mask_background=255)'
        )
        raise InputError(msg)


def _read_any_image(message: SerializedMessage) -> AnyImage:
    if message.type_name == IMAGE:
        return read_image(message.data)
    return read_compressed_image(message.data)


def _encodings(messages: RecordingReader, names: Sequence[str]) -> Mapping[str, str]:
    """Return the encoding of the first image of each topic in `names`."""
    encodings: dict[str, str] = {}
    for number, message in enumerate(messages):
        if number > _MOST_PEEKED or len(encodings) == len(names):
            break
        if message.topic in names and message.topic not in encodings:
            try:
                image = _read_any_image(message)
            except DamagedMessageError:
                continue
            encodings[message.topic] = (
                image.layout.encoding if isinstance(image, StampedImage) else image.format
            )
    return encodings


def _left_out(count: int, what: str, why: str) -> list[str]:
    return [f'{count} of {what} were left out: they {why}'] if count else []
