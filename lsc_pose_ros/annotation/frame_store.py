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
"""The frames of a recording in any order: depth images on the disk, all else in memory."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.annotation.recording_content import RecordingContent
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.temporary import temporary_file

_Number = TypeVar('_Number', np.float32, np.int32)


class StoredFrame(NamedTuple):
    """A frame without its images, and where these are."""

    frame: Frame
    at: int


class FrameStore:
    """Each N-th frame of a recording; the images are in a file that ends with the program.

    Attributes:
        numbers: the numbers of the stored frames in the recording.
        all_stamps: the stamps of all frames of the recording, nanoseconds.
        content: the hash of the whole recording, `RecordingContent`, whichever frames are stored.
    """

    def __init__(self, frames: Iterable[Frame], every: int = 1) -> None:
        """Read all frames of a recording, and store each one whose number `every` divides.

        Raises:
            InputError: no temporary file can hold the images.
        """
        self._file = temporary_file()
        self._frames: list[StoredFrame] = []
        self.numbers: list[int] = []
        content = RecordingContent()
        for number, frame in enumerate(frames):
            content.add(frame)
            if number % every == 0:
                self.numbers.append(number)
                with _storing():
                    self._store(frame)
        with _storing():
            self._file.flush()
        self.all_stamps = content.stamps
        self.content = content.hash()

    def _store(self, frame: Frame) -> None:
        at = self._file.tell()
        self._file.write(np.ascontiguousarray(frame.depth).tobytes())
        self._file.write(np.ascontiguousarray(frame.labels).tobytes())
        nothing = np.zeros((0, *frame.depth.shape[1:]))
        stored = frame._replace(depth=nothing.astype(np.float32), labels=nothing.astype(np.int32))
        self._frames.append(StoredFrame(stored, at))

    def __len__(self) -> int:
        """Return the number of stored frames."""
        return len(self._frames)

    @property
    def stamps(self) -> list[int]:
        """The stamps of the stored frames, nanoseconds."""
        return [stored.frame.stamp for stored in self._frames]

    def __getitem__(self, number: int) -> Frame:
        """Return the stored frame `number`, which is the frame `numbers[number]`."""
        stored = self._frames[number]
        end = self._frames[number + 1].at if number + 1 < len(self._frames) else self._end
        size = (end - stored.at) // (np.dtype(np.float32).itemsize + np.dtype(np.int32).itemsize)
        self._file.seek(stored.at)
        depth = self._read(size, np.dtype(np.float32))
        labels = self._read(size, np.dtype(np.int32))
        shape = -1, stored.frame.depth.shape[1]
        return stored.frame._replace(depth=depth.reshape(shape), labels=labels.reshape(shape))

    @property
    def _end(self) -> int:
        return self._file.seek(0, 2)

    def _read(self, count: int, dtype: np.dtype[_Number]) -> NDArray[_Number]:
        return np.frombuffer(self._file.read(count * dtype.itemsize), dtype).copy()


@contextmanager
def _storing() -> Iterator[None]:
    """Turn errors of the system into a sentence about the temporary folder.

    Raises:
        InputError: it is full.
    """
    try:
        yield
    except OSError as error:
        msg = (
            f'no temporary file can hold the depth images ({error.strerror}); name a folder with '
            'more room in the variable TMPDIR'
        )
        raise InputError(msg) from error
