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
"""Writes the labelled recording of an annotation, and tells whose labels it holds."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.annotation.recording_content import RecordingContent
from lsc_pose_ros.bags import FrameReader, RecordingWriter
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.labelled_copy import LabelCounts, write_labelled_copy
from lsc_pose_ros.labels.tracks import skeletons_of


class WrittenRecording(NamedTuple):
    """What was written.

    Attributes:
        text: what to tell of it.
        complete: the stamps of the frames all of whose labels it has, nanoseconds.
    """

    text: str
    complete: frozenset[int]


class OutputGuard:
    """Sees whether another program has written an output since this one has read it.

    Attributes:
        path: the output.
        journal: where the labels are if it cannot be written.
        is_newer: whether the output was written after the last change in the journal.
    """

    def __init__(self, path: Path, journal: Path) -> None:
        """Remember what is there.

        Args:
            path: the output.
            journal: where the labels are if it cannot be written, for the message.
        """
        self.path, self.journal = path, journal
        self._before = self._state()
        self.is_newer = self._is_newer()

    def check(self) -> None:
        """Check that the output is the one that was there, or is not there any more.

        Raises:
            InputError: it is another one.
        """
        now = self._state()
        if now is not None and now != self._before:
            msg = (
                f'another program has written {self.path} meanwhile, so it is not replaced; the '
                f'labels are in {self.journal}: stop the command and give it again'
            )
            raise InputError(msg)

    def _is_newer(self) -> bool:
        if self._before is None:
            return False
        try:
            journal = self.journal.stat()
        except OSError:
            return False
        *_, written = self._before
        return journal.st_size > 0 and written > journal.st_mtime_ns

    def _state(self) -> tuple[int, ...] | None:
        try:
            state = self.path.stat()
        except OSError:
            return None
        return state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns


class AnnotatedFrames:
    """The finished labels as a source for `write_labelled_copy`."""

    warnings: tuple[str, ...] = ()

    def __init__(self, finished: Mapping[int, Skeletons]) -> None:
        """Use labels by stamp."""
        self._finished = finished

    def at(self, number: int, frame: Frame) -> Skeletons:  # noqa: ARG002 - stamps are enough
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        return self._finished.get(frame.stamp, skeletons_of({}))

    def why_none(self, number: int, frame: Frame) -> str:  # noqa: ARG002
        """Return why a frame has no label; as `LabelSource.why_none`."""
        return 'without a body' if frame.stamp in self._finished else 'that are not done'


def write_labelled_recording(
    frames: FrameReader, finished: Mapping[int, Skeletons], output: OutputGuard, content: str
) -> WrittenRecording:
    """Write a copy of a recording with labels.

    Args:
        frames: the frames, not turned upright.
        finished: the labels by stamp, nanoseconds.
        output: the file to write, as it was when its labels were read.
        content: the hash of the recording that is labelled, `RecordingContent`.

    Raises:
        InputError: the recording cannot be read or has another content, or the output cannot be
            written; then this is as before.
    """
    output.check()
    counts, complete, read = LabelCounts(), set(), RecordingContent()
    with RecordingWriter(output.path) as writer:
        source = AnnotatedFrames(finished)
        for frame in write_labelled_copy(frames, source, writer, counts):
            read.add(frame)
            wanted, written = finished.get(frame.stamp), frame.ground_truth
            if wanted is None or written is None:
                continue
            if known_bodies(written) == known_bodies(wanted):
                complete.add(frame.stamp)
        if read.hash() != content:
            msg = (
                f'{frames.path} is another recording than the one that was labelled; the labels '
                f'are in {output.journal}: put that recording back and give the command again'
            )
            raise InputError(msg)
        output.check()
    text = (
        f'{os.fspath(output.path)}: {counts.frames} frames, {counts.labelled} of them '
        f'labelled, {_bodies(counts.bodies)}'
    )
    if counts.unmatched == 1:
        text += '; 1 body was left out, because no mask shows it'
    elif counts.unmatched:
        text += f'; {counts.unmatched} bodies were left out, because no mask shows them'
    return WrittenRecording(text, frozenset(complete))


def _bodies(count: int) -> str:
    return f'{count} {"body" if count == 1 else "bodies"}'
