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
"""The journal of an annotation: each change is on the disk before the page is told so.

It is a text of one JSON object a line. The first line names the recording; each further line has
the labels of one frame, and the last line of a frame holds. A crash can cut the last line off,
which is then left out.
"""

import json
import os
from pathlib import Path
from typing import Any, BinaryIO

from lsc_pose_ros.annotation.frame_labels import FrameLabels, from_json
from lsc_pose_ros.errors import InputError

FORMAT = 'lsc_pose annotation'
VERSION = 1

Frames = dict[int, tuple[FrameLabels, bool]]
"""By stamp in nanoseconds: the labels of a frame, and whether it is done."""


class Journal:
    """Keeps the changes of an annotation."""

    def __init__(self, path: Path, recording: str, stamps: list[int]) -> None:
        """Read what there is, and open the journal for more.

        Args:
            path: the file; it is made if it is not there.
            recording: the name of the recording.
            stamps: of all of its frames, nanoseconds.

        Raises:
            InputError: the file is no journal, or that of another recording, or cannot be
                written.
        """
        self.path = path
        self.frames: Frames = {}
        beginning = {
            'format': FORMAT, 'version': VERSION, 'recording': recording,
            'first': stamps[0], 'count': len(stamps),
        }  # fmt: skip
        try:
            end = self._read(beginning) if path.exists() else 0
            self._stream: BinaryIO = path.open('r+b' if end else 'wb')
        except OSError as error:
            msg = f'{path}: {error.strerror}'
            raise InputError(msg) from error
        self._stream.truncate(end)
        self._stream.seek(end)
        if not end:
            self._append(beginning)

    def close(self) -> None:
        """Close the file."""
        self._stream.close()

    def keep(self, stamp: int, bodies: list[dict[str, Any]], *, done: bool) -> None:
        """Keep the labels of a frame; they are on the disk when this returns.

        Args:
            stamp: of the frame, nanoseconds.
            bodies: the labels, as `as_json` returns them.
            done: whether the frame is done.

        Raises:
            InputError: they are no labels, or the disk is full.
        """
        labels = from_json(bodies)
        try:
            self._append({'stamp': stamp, 'bodies': bodies, 'done': done})
        except OSError as error:
            msg = f'{self.path}: {error.strerror}; the change is not kept'
            raise InputError(msg) from error
        self.frames[stamp] = labels, done

    def remove(self) -> None:
        """Close and delete the journal, after the labelled recording is written."""
        self._stream.close()
        self.path.unlink(missing_ok=True)

    def _append(self, content: dict[str, Any]) -> None:
        begin = self._stream.tell()
        try:
            self._stream.write(json.dumps(content).encode() + b'\n')
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError:
            self._stream.seek(begin)
            self._stream.truncate(begin)
            raise

    def _read(self, beginning: dict[str, Any]) -> int:
        """Read the file, and return where its last complete line ends."""
        lines = self.path.read_bytes().split(b'\n')[:-1]  # what follows the last line end is cut
        if not lines:
            return 0
        if _parsed(lines[0]) != beginning:
            msg = (
                f'{self.path} is not the journal of this recording; move it away, or name another '
                'output with -o'
            )
            raise InputError(msg)
        end = len(lines[0]) + 1
        for line in lines[1:]:
            entry = _parsed(line)
            if not isinstance(entry, dict) or type(entry.get('stamp')) is not int:
                break
            self.frames[entry['stamp']] = from_json(entry.get('bodies')), entry.get('done') is True
            end += len(line) + 1
        return end


def _parsed(line: bytes) -> Any:  # noqa: ANN401 - any JSON
    try:
        return json.loads(line)
    except ValueError:
        return None
