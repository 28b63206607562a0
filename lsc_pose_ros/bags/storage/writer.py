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

"""Writes recordings that rosbag2 can play: an MCAP file, alone or in a bag folder."""

from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

from mcap.writer import CompressionType, Writer

from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    markers_message,
    mask_message,
    skeletons_message,
)
from lsc_pose_ros.bags.serialization.type_store import type_definition, type_hash
from lsc_pose_ros.bags.storage.layout import MCAP_MAGIC
from lsc_pose_ros.bags.storage.metadata import (
    RecordingContents,
    WrittenTopic,
    metadata_text,
    metadata_yaml,
    qos_text,
)
from lsc_pose_ros.bags.storage.recorded_metadata import METADATA_NAME
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS, Topics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import TEXT, begins_with
from lsc_pose_ros.files.output_file import OutputFile, OutputFolder, write_output
from lsc_pose_ros.files.output_place import check_output, is_written_through, writing
from lsc_pose_ros.files.sibling_names import sibling
from lsc_pose_ros.messages.markers import MarkerShape
from lsc_pose_ros.messages.type_names import CAMERA_INFO, IMAGE, MARKER_ARRAY, POINT_CLOUD

RECORDING = begins_with('a recording of the format MCAP', MCAP_MAGIC)

MCAP_SUFFIX = '.mcap'
_CHUNK_SIZE = 1 << 20
_LIBRARY = 'lsc_pose_ros'


class RecordingWriter:
    """Writes a recording; a context manager.

    The recording is written under a temporary name, and renamed at the end or removed after an
    error; what a process that is killed has written can be read under that name. Equal messages
    give equal files.
    """

    def __init__(self, path: Path | str) -> None:
        """Check the path; nothing is written before the context is entered.

        Args:
            path: with the suffix .mcap one file, which is replaced if it is a recording; without
                a suffix a bag folder, which must not exist; a device or a pipe; or '-', standard
                output.

        Raises:
            InputError: the path is neither, or there is something in the way.
        """
        self._path = Path(path)
        self._folder = not self._path.suffix and not is_written_through(self._path)
        self._check_path()
        self._file_name = self._path.name
        if self._folder:
            self._file_name = sibling(self._path, f'_0{MCAP_SUFFIX}').name
        self._bag: Path | None = None
        self._opened = ExitStack()
        self._channels: dict[str, _Channel] = {}
        self._schemas: dict[str, int] = {}
        self._start: int | None = None
        self._shift = 0
        self._end: int | None = None
        self._mcap: Writer | None = None

    @property
    def path(self) -> Path:
        """The path of the finished recording."""
        return self._path

    def __enter__(self) -> 'RecordingWriter':  # noqa: PYI034 - typing.Self is of Python 3.11
        """Create the file.

        Raises:
            InputError: the path cannot be written to.
        """
        with ExitStack() as stack:
            path = self._path
            if self._folder:
                self._bag = stack.enter_context(OutputFolder(path))
                path = self._bag / self._file_name
            stream = stack.enter_context(OutputFile(path, RECORDING))
            self._mcap = Writer(
                stream,
                chunk_size=_CHUNK_SIZE,
                compression=CompressionType.ZSTD,
                enable_data_crcs=True,
            )
            with writing(path):
                self._mcap.start(profile='ros2', library=_LIBRARY)
            self._opened = stack.pop_all()
        return self

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Finish and rename the recording, or remove it after an error.

        Raises:
            InputError: it cannot be finished, for example because the disk is full.
        """
        if error is not None:
            self._opened.__exit__(error_type, error, traceback)
            return
        with self._opened, writing(self._path):
            self._finish()

    def write(self, topic: str, type_name: str, stamp_ns: int, data: bytes) -> None:
        """Write one serialized message.

        Args:
            topic: the name of the topic.
            type_name: the message type, for example 'sensor_msgs/msg/Image'.
            stamp_ns: the log time, nanoseconds. MCAP has no times before 1970: if the first one
                is negative, all are shifted so that it becomes 0.
            data: the message as CDR.

        Raises:
            InputError: the type is unknown or the disk is full.
        """
        if self._mcap is None:
            msg = f'{self._path}: the recording is not open'
            raise RuntimeError(msg)
        if self._start is None:
            self._shift = max(0, -stamp_ns)
        stamp_ns = max(0, stamp_ns + self._shift)
        with writing(self._path):
            channel = self._channels.get(topic) or self._add_channel(self._mcap, topic, type_name)
            self._mcap.add_message(channel.number, stamp_ns, data, stamp_ns)
        channel.count += 1
        self._start = stamp_ns if self._start is None else min(self._start, stamp_ns)
        self._end = stamp_ns if self._end is None else max(self._end, stamp_ns)

    def write_frame(
        self, frame: Frame, topics: Topics = DEFAULT_TOPICS, *, mask_background: int = 0
    ) -> None:
        """Write a frame: depth image (16UC1), camera info, mask, and ground truth if it has any.

        Args:
            frame: the frame.
            topics: the names of the topics; a topic that is '' is not written.
            mask_background: the mask's pixel value for no body.

        Raises:
            InputError: a body has the background's number, or the disk is full.
        """
        stamp, frame_id = frame.stamp, frame.frame_id
        shape = frame.depth.shape
        if topics.depth:
            self.write(topics.depth, IMAGE, stamp, depth_message(stamp, frame_id, frame.depth))
        if topics.camera_info:
            info = camera_info_message(stamp, frame_id, frame.camera, shape)
            self.write(topics.camera_info, CAMERA_INFO, stamp, info)
        if topics.mask:
            mask = mask_message(stamp, frame_id, frame.labels, mask_background)
            self.write(topics.mask, IMAGE, stamp, mask)
        if topics.ground_truth and frame.ground_truth is not None:
            self.write_skeletons(topics.ground_truth, stamp, frame_id, frame.ground_truth)

    def write_skeletons(self, topic: str, stamp: int, frame_id: str, skeletons: Skeletons) -> None:
        """Write skeletons as sensor_msgs/PointCloud2.

        Args:
            topic: the name of the topic.
            stamp: the depth image's, nanoseconds.
            frame_id: the camera's optical frame.
            skeletons: the skeletons.
        """
        self.write(topic, POINT_CLOUD, stamp, skeletons_message(stamp, frame_id, skeletons))

    def write_markers(
        self, topic: str, stamp: int, frame_id: str, markers: list[MarkerShape]
    ) -> None:
        """Write shapes as visualization_msgs/MarkerArray.

        Args:
            topic: the name of the topic.
            stamp: the depth image's, nanoseconds.
            frame_id: the camera's optical frame.
            markers: the shapes.
        """
        self.write(topic, MARKER_ARRAY, stamp, markers_message(stamp, frame_id, markers))

    def _add_channel(self, mcap: Writer, topic: str, type_name: str) -> '_Channel':
        if type_name not in self._schemas:
            text = type_definition(type_name).encode()
            self._schemas[type_name] = mcap.register_schema(type_name, 'ros2msg', text)
        details = {
            'offered_qos_profiles': qos_text(),
            'topic_type_hash': type_hash(type_name),
        }
        number = mcap.register_channel(topic, 'cdr', self._schemas[type_name], details)
        channel = self._channels[topic] = _Channel(number, type_name)
        return channel

    def _finish(self) -> None:
        if self._mcap is None:
            return
        written = self._written()
        self._mcap.add_metadata('rosbag2', {'serialized_metadata': metadata_text(written)})
        self._mcap.finish()  # type: ignore[no-untyped-call]
        if self._bag is not None:
            write_output(self._bag / METADATA_NAME, TEXT, metadata_yaml(written).encode())

    def _written(self) -> RecordingContents:
        topics = [
            WrittenTopic(name, channel.type_name, type_hash(channel.type_name), channel.count)
            for name, channel in self._channels.items()
        ]
        # The name of a single file is not stored, so that equal recordings are equal files.
        name = self._file_name if self._folder else f'recording{MCAP_SUFFIX}'
        return RecordingContents(name, topics, self._start, self._end)

    def _check_path(self) -> None:
        if self._folder:
            OutputFolder(self._path)
            return
        if self._path.suffix != MCAP_SUFFIX and not is_written_through(self._path):
            msg = (
                f'{self._path}: a recording is written as a file .mcap or as a folder '
                f'(a name without suffix), not as {self._path.suffix}'
            )
            raise InputError(msg)
        check_output(self._path, RECORDING)


class _Channel:
    """A topic, and the number of its written messages."""

    def __init__(self, number: int, type_name: str) -> None:
        self.number = number
        self.type_name = type_name
        self.count = 0
