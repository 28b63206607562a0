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
from typing import Any

from lsc_pose_ros.annotation.depth_picture import depth_picture
from lsc_pose_ros.annotation.frame_labels import (
    FARTHEST,
    NEAREST,
    FrameLabels,
    as_json,
    joint_at,
    labels_of,
    people_box,
    position_at,
    skeletons_from,
)
from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, drawn_edges
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.tracks import skeletons_of

LIMBS = [[JOINT_NAMES[end] for end in edge] for edge in drawn_edges(range(len(JOINT_NAMES)))]
"""The lines of a skeleton, as pairs of joints."""

Start = Callable[[Frame], Skeletons]
"""Returns the skeletons with which a frame begins that has no labels."""


class Session:
    """An annotation; its methods can be called from any thread."""

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
                'done': self._is_done(frame.stamp),
                'people': people_box(frame.labels),
                'bodies': as_json(self._labels(frame), frame.camera),
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
            return {'position': placed.position.tolist(), 'depthFrom': placed.depth_from}

    def at_depth(self, number: int, pixel: tuple[float, float], z: float) -> dict[str, Any]:
        """Return the point at depth `z`, metres, that a pixel of a frame shows.

        Raises:
            InputError: there is no such frame, or no joint can have this depth.
        """
        if not NEAREST <= z <= FARTHEST:
            msg = f'the depth must be {NEAREST:g} to {FARTHEST:g} m'
            raise InputError(msg)
        with self._lock:
            position = position_at(pixel, z, self._frame(number).camera)
            return {'position': position.tolist()}

    def keep(self, number: int, bodies: list[dict[str, Any]], *, done: bool) -> dict[str, Any]:
        """Keep the labels of a frame, and return them as `frame` does.

        Raises:
            InputError: they are no labels, or cannot be written.
        """
        with self._lock:
            stamp = self._frame(number).stamp
            self._journal.keep(stamp, bodies, done=done)
        return self.frame(number)

    def finished(self) -> dict[int, Skeletons]:
        """Return the labels of the frames that are done, by their stamps."""
        with self._lock:
            return self._earlier | {
                stamp: skeletons_from(labels)
                for stamp, (labels, done) in self._journal.frames.items()
                if done
            }

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


class AnnotatedFrames:
    """The finished labels as a source for `write_labelled_copy`."""

    warnings: tuple[str, ...] = ()

    def __init__(self, finished: dict[int, Skeletons]) -> None:
        """Use labels by stamp."""
        self._finished = finished

    def at(self, number: int, frame: Frame) -> Skeletons:  # noqa: ARG002 - stamps are enough
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        return self._finished.get(frame.stamp, skeletons_of({}))

    def why_none(self, number: int, frame: Frame) -> str:  # noqa: ARG002
        """Return why a frame has no label; as `LabelSource.why_none`."""
        return 'without a body' if frame.stamp in self._finished else 'that are not done'


def _joint(name: str) -> int:
    if name not in JOINT_NUMBERS:
        msg = f'there is no joint {name[:40]!r}'
        raise InputError(msg)
    return JOINT_NUMBERS[name]
