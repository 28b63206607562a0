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

It is a text of one JSON object a line. The first line tells the content of the recording; each
further line has the labels of one frame, and the last line of a frame holds.

A crash can cut the last line off, which is then left out. Lines before it that are damaged are
left out, too, and the damaged file is kept under another name.
"""

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any, NamedTuple

from lsc_pose_ros.annotation.frame_labels import FrameLabels, from_json, without_pixels
from lsc_pose_ros.annotation.journal_file import JournalFile
from lsc_pose_ros.errors import InputError

FORMAT = 'lsc_pose annotation'
VERSION = 2


class RecordingIdentity(NamedTuple):
    """Which recording is annotated.

    Attributes:
        name: of its file, for messages; the file may be renamed.
        content: the hash of its content, `FrameStore.content`.
        stamps: of all of its frames, nanoseconds.
    """

    name: str
    content: str
    stamps: Collection[int]


class Journal:
    """Keeps the changes of an annotation.

    Attributes:
        frames: by stamp in nanoseconds, the labels of a frame, and whether it is done.
        warnings: what of the file could not be read.
    """

    def __init__(self, file: JournalFile, recording: RecordingIdentity) -> None:
        """Read what the file has; if it is damaged, it is set aside and written anew.

        Args:
            file: is read and written.
            recording: what is annotated.

        Raises:
            InputError: the file is the journal of another recording, or cannot be written.
        """
        self.frames: dict[int, tuple[FrameLabels, bool]] = {}
        self.warnings: list[str] = []
        self._file, self._recording = file, recording
        self._beginning = _line(
            {
                'format': FORMAT,
                'version': VERSION,
                'recording': recording.name,
                'content': recording.content,
            }
        )
        content = file.content()
        # A crash can have cut off the first line; then there was no change yet.
        self._is_empty = self._beginning.startswith(content)
        if self._is_empty:
            file.clear()
        else:
            self._read(content)

    @property
    def path(self) -> Path:
        """The name of the file."""
        return self._file.path

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def keep(self, stamp: int, labels: FrameLabels, *, done: bool) -> None:
        """Keep the labels of a frame; they are on the disk when this returns.

        Args:
            stamp: of the frame, nanoseconds.
            labels: of the frame.
            done: whether the frame is done.

        Raises:
            RefusedError: they cannot be written.
        """
        line = _line({'stamp': stamp, 'bodies': without_pixels(labels), 'done': done})
        self._file.append(self._beginning + line if self._is_empty else line)
        self._is_empty = False
        self.frames[stamp] = labels, done

    def remove(self) -> None:
        """Close and delete the file, when all that it has is in a labelled recording."""
        self._file.remove()

    def _read(self, content: bytes) -> None:
        first, *lines = content.split(b'\n')
        self._check_beginning(first)
        cut_off = lines.pop() if lines else b''  # what follows the last line end
        sound = [line for line in lines if self._take(line)]
        if len(sound) < len(lines):
            self.warnings.append(
                f'{self.path}: {len(lines) - len(sound)} of {len(lines)} changes cannot be read, '
                f'and are left out; the damaged file is kept as {self._file.set_aside()}'
            )
        if self._take(cut_off):  # only its line end is missing
            sound.append(cut_off)
        elif cut_off:
            self.warnings.append(f'{self.path}: the last change was cut off, and is left out')
        repaired = b''.join(line + b'\n' for line in (first, *sound))
        if repaired != content:
            self._file.replace(repaired)

    def _check_beginning(self, line: bytes) -> None:
        beginning = _parsed(line)
        remedy = 'move it away, or name another output with -o'
        if not isinstance(beginning, dict) or beginning.get('format') != FORMAT:
            msg = f'{self.path}: the first line is damaged; {remedy}'
            raise InputError(msg)
        if beginning.get('version') != VERSION:
            msg = f'{self.path} is of another version of lsc_pose annotate; {remedy}'
            raise InputError(msg)
        if beginning.get('content') != self._recording.content:
            name = str(beginning.get('recording'))[:200]
            msg = (
                f'{self.path} is the journal of another recording, {name}, or of one that '
                f'was read with other options; {remedy}'
            )
            raise InputError(msg)

    def _take(self, line: bytes) -> bool:
        """Take the labels of a line, and return whether it has any."""
        entry = _parsed(line)
        if not isinstance(entry, dict) or type(entry.get('done')) is not bool:
            return False
        stamp = entry.get('stamp')
        if type(stamp) is not int or stamp not in self._recording.stamps:
            return False
        try:
            self.frames[stamp] = from_json(entry.get('bodies')), entry['done']
        except InputError:
            return False
        return True


def _line(content: dict[str, Any]) -> bytes:
    return json.dumps(content).encode() + b'\n'


def _parsed(line: bytes) -> Any:  # noqa: ANN401 - any JSON
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
