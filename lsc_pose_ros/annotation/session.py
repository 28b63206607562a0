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
"""What the page works on: the frames, their labels, and what is done."""

import threading
from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from enum import Enum, auto
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.annotation.depth_picture import depth_picture
from lsc_pose_ros.annotation.frame_labels import (
    FARTHEST,
    NEAREST,
    FrameLabels,
    from_json,
    joint_at,
    labels_of,
    people_box,
    position_at,
    skeletons_from,
    with_pixels,
)
from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal
from lsc_pose_ros.annotation.labelled_recording import WrittenRecording
from lsc_pose_ros.annotation.refusals import Reason, RefusedError
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, drawn_edges
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError

LIMBS = [[JOINT_NAMES[end] for end in edge] for edge in drawn_edges(range(len(JOINT_NAMES)))]
"""The lines of a skeleton, as pairs of joints."""

_MOST_TOLD = 5

Start = Callable[[Frame], Skeletons]
"""Returns the skeletons with which a frame begins that has no labels."""


class _State(Enum):
    OPEN = auto()
    BEING_WRITTEN = auto()
    ENDED = auto()


class Session:
    """An annotation; its methods can be called from any thread.

    Each frame has a revision, which a change makes larger. A page says which one it has changed,
    so that it does not replace what another page has done meanwhile.
    """

    def __init__(
        self,
        name: str,
        store: FrameStore,
        journal: Journal,
        start: Start,
        earlier: Mapping[int, Skeletons] | None = None,
    ) -> None:
        """Prepare.

        Args:
            name: of the recording.
            store: its frames.
            journal: keeps the changes.
            start: returns the first labels of a frame that has none.
            earlier: the labels of an earlier annotation, by stamp; these frames are done.
        """
        self._earlier = dict(earlier or {})
        self._name, self._store, self._journal, self._start = name, store, journal, start
        self._begun: dict[int, FrameLabels] = {}
        self._revisions: dict[int, int] = {}
        self._state = _State.OPEN
        self._lock = threading.Lock()

    def recording(self) -> dict[str, Any]:
        """Return what the page needs to know of the recording."""
        with self._lock:
            return {
                'name': self._name,
                'joints': list(JOINT_NAMES),
                'limbs': LIMBS,
                'depths': [NEAREST, FARTHEST],
                'numbers': self._store.numbers,
                'count': len(self._store.all_stamps),
                'done': [self._is_done(stamp) for stamp in self._store.stamps],
            }

    def frame(self, number: int) -> dict[str, Any]:
        """Return the labels of a frame.

        Raises:
            InputError: there is no such frame.
        """
        with self._lock:
            frame = self._frame(number)
            height, width = frame.depth.shape
            return {
                'number': number,
                'width': width,
                'height': height,
                'revision': self._revisions.get(frame.stamp, 0),
                'done': self._is_done(frame.stamp),
                'people': people_box(frame.labels),
                'bodies': with_pixels(self._labels(frame), frame.camera),
            }

    def picture(self, number: int) -> bytes:
        """Return the depth image of a frame as PNG.

        Raises:
            InputError: there is no such frame.
        """
        with self._lock:
            return depth_picture(self._frame(number).depth)

    def place(
        self, number: int, body: int, joint: str, pixel: tuple[float, float]
    ) -> dict[str, Any]:
        """Return the position, metres, of a joint that is put on a pixel, and whence its depth.

        Raises:
            InputError: there is no such frame, body or joint.
        """
        with self._lock:
            frame, index = self._frame(number), _joint(joint)
            labels = self._labels(frame)
            if body not in labels:
                msg = f'frame {self._store.numbers[number]} has no body {body}'
                raise InputError(msg)
            placed = joint_at(pixel, index, frame, labels[body].positions[index])
            return {**_position(placed.position), 'depthFrom': placed.depth_from}

    def at_depth(self, number: int, pixel: tuple[float, float], z: float) -> dict[str, Any]:
        """Return the point at depth `z`, metres, that a pixel of a frame shows.

        Raises:
            InputError: there is no such frame, or no joint can have this depth.
        """
        if not NEAREST <= z <= FARTHEST:
            msg = f'the depth must be {NEAREST:g} to {FARTHEST:g} m'
            raise InputError(msg)
        with self._lock:
            return _position(position_at(pixel, z, self._frame(number).camera))

    def keep(self, number: int, bodies: object, *, done: bool, revision: object) -> dict[str, Any]:
        """Keep the labels of a frame, and return them as `frame` does.

        Args:
            number: of the frame.
            bodies: its labels, as `frame` returns them.
            done: whether the frame is done.
            revision: that of the labels that were changed.

        Raises:
            InputError: they are no labels.
            RefusedError: another page has changed the frame meanwhile, the recording is being
                written or is written, or the disk is full.
        """
        labels = from_json(bodies)
        with self._lock:
            stamp = self._frame(number).stamp
            self._refuse_unless_open('the change is not kept')
            if type(revision) is not int or revision != self._revisions.get(stamp, 0):
                msg = (
                    f'frame {self._store.numbers[number]} was changed on another page meanwhile; '
                    'the change is not kept'
                )
                raise RefusedError(msg, Reason.STALE)
            self._journal.keep(stamp, labels, done=done)
            self._revisions[stamp] = self._revisions.get(stamp, 0) + 1
        return self.frame(number)

    def finish(self, write: Callable[[Mapping[int, Skeletons]], WrittenRecording]) -> str:
        """Write the labelled recording, and return what to tell of it.

        Nothing is kept meanwhile, nor after it. The journal is deleted if the recording has all
        that it holds; else it stays.

        Args:
            write: writes the recording with labels by their stamps.

        Raises:
            InputError: no frame is done, or the recording cannot be written; then the annotation
                goes on.
            RefusedError: the recording is being written already, or is written.
        """
        with self._lock:
            self._refuse_unless_open('it is not written again')
            finished = self._finished()
            if not finished:
                msg = 'no frame is done yet: press Enter on each frame whose joints are right'
                raise InputError(msg)
            self._state = _State.BEING_WRITTEN
        try:
            written = write(finished)
        except BaseException:
            with self._lock:
                if self._state is _State.BEING_WRITTEN:
                    self._state = _State.OPEN
            raise
        with self._lock:
            self._state = _State.ENDED
            return written.text + self._end(written.complete)

    def close(self) -> None:
        """End the annotation; nothing is kept after it."""
        with self._lock:
            self._state = _State.ENDED
            self._journal.close()

    def _refuse_unless_open(self, consequence: str) -> None:
        if self._state is _State.BEING_WRITTEN:
            msg = f'the recording is being written; {consequence}'
            raise RefusedError(msg, Reason.BEING_WRITTEN)
        if self._state is _State.ENDED:
            msg = f'the annotation has ended; {consequence}. Start the command again to go on'
            raise RefusedError(msg, Reason.ENDED)

    def _finished(self) -> dict[int, Skeletons]:
        """Return the labels of the frames that are done, by their stamps."""
        return self._earlier | {
            stamp: skeletons_from(labels)
            for stamp, (labels, done) in self._journal.frames.items()
            if done
        }

    def _end(self, complete: AbstractSet[int]) -> str:
        """Delete the journal if the recording has all of it; return what to tell if not."""
        missing = {
            self._store.all_stamps.index(stamp): 'a body was left out' if done else 'not done'
            for stamp, (_, done) in self._journal.frames.items()
            if not done or stamp not in complete
        }
        if not missing:
            self._journal.remove()
            return ''
        self._journal.close()
        told = [f'frame {at} ({why})' for at, why in sorted(missing.items())[:_MOST_TOLD]]
        if len(missing) > _MOST_TOLD:
            told.append(f'{len(missing) - _MOST_TOLD} more')
        return f'; {self._journal.path} keeps what is missing there: {", ".join(told)}'

    def _frame(self, number: int) -> Frame:
        if not 0 <= number < len(self._store):
            msg = f'there is no frame {number}; the recording has {len(self._store)}'
            raise InputError(msg)
        return self._store[number]

    def _is_done(self, stamp: int) -> bool:
        return self._journal.frames.get(stamp, ({}, stamp in self._earlier))[1]

    def _labels(self, frame: Frame) -> FrameLabels:
        kept = self._journal.frames.get(frame.stamp)
        if kept is not None:
            return kept[0]
        if frame.stamp not in self._begun:
            truth = self._earlier.get(frame.stamp, frame.ground_truth)
            has_labels = truth is not None and bool(len(truth.bodies))
            begin = truth if has_labels and truth is not None else self._start(frame)
            self._begun[frame.stamp] = labels_of(begin)
        return self._begun[frame.stamp]


def _position(position: NDArray[np.float64]) -> dict[str, Any]:
    if not np.isfinite(position).all():
        msg = 'no joint can be there: the pixel is outside of the field of the lens'
        raise InputError(msg)
    return {'position': position.tolist()}


def _joint(name: str) -> int:
    if name not in JOINT_NUMBERS:
        msg = f'there is no joint {name[:40]!r}'
        raise InputError(msg)
    return JOINT_NUMBERS[name]
