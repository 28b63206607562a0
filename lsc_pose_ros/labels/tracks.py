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

"""Joints over time, and the labels of a depth image that are interpolated from them."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.interpolation import between, bracket
from lsc_pose_ros.labels.limits import known_positions
from lsc_pose_ros.labels.transform_history import IDENTITY, Pose, TransformHistory
from lsc_pose_ros.labels.vocabulary import Vocabulary

ALL_JOINTS = np.arange(len(JOINT_NAMES), dtype=np.uint16)

NOWHERE = 'with labels that have no position'
"""Why a frame has no label though a source knows its moment; as `LabelSource.why_none`."""

CAMERA_FRAME = ''
"""Stands for the optical frame of the depth image as the frame of a track."""


class LabelSettings(NamedTuple):
    """How labels are made of what another program has.

    Attributes:
        vocabulary: the joints of the other program.
        longest_gap: the longest time between two samples that is interpolated, nanoseconds.
        time_offset: is added to the stamps of the other program, nanoseconds.
        with_offsets: whether joints are moved to where they are in our anatomy.
    """

    vocabulary: Vocabulary
    longest_gap: int
    time_offset: int = 0
    with_offsets: bool = True


class LabelSource(Protocol):
    """Knows the labels of depth images.

    Attributes:
        warnings: a sentence for each reason why labels are missing.
    """

    @property
    def warnings(self) -> Sequence[str]:
        """A sentence for each reason why labels are missing."""

    def at(self, number: int, frame: Frame) -> Skeletons:
        """Return the labelled bodies of a frame, without those of which nothing is known.

        Args:
            number: of the depth image in the recording, from 0.
            frame: the frame, not turned upright.
        """

    def why_none(self, number: int, frame: Frame) -> str:
        """Return why `at` has no body in a frame, in words that follow 'N frames'.

        Args:
            number: of the depth image in the recording, from 0.
            frame: the frame, not turned upright.
        """


class JointSample(NamedTuple):
    """One joint of another program; `stamp` in nanoseconds, `joint` an index into its names."""

    stamp: int
    frame_id: str
    body: int
    joint: int
    position: Sequence[float] | NDArray[np.floating]


class BodyTrack(NamedTuple):
    """One body over time.

    Attributes:
        body: its number.
        frame_id: the frame of the positions, or CAMERA_FRAME.
        stamps: nanoseconds, ascending, shape (T,).
        positions: of our joints, metres, NaN if unknown, shape (T, 20, 3).
    """

    body: int
    frame_id: str
    stamps: NDArray[np.int64]
    positions: NDArray[np.float64]


def body_tracks(samples: Iterable[JointSample], vocabulary: Vocabulary) -> list[BodyTrack]:
    """Return the tracks of all bodies, sorted by their numbers and frames."""
    moments: dict[tuple[int, str], dict[int, NDArray[np.float64]]] = defaultdict(dict)
    count = len(vocabulary.names)
    for sample in samples:
        of_body = moments[sample.body, sample.frame_id]
        joints = of_body.setdefault(sample.stamp, np.full((count, 3), np.nan))
        joints[sample.joint] = sample.position
    tracks = []
    for (body, frame_id), by_stamp in sorted(moments.items()):
        stamps = np.array(sorted(by_stamp), np.int64)
        theirs = np.stack([by_stamp[int(stamp)] for stamp in stamps])
        ours = vocabulary.ours(known_positions(theirs))
        tracks.append(BodyTrack(body, frame_id, stamps, ours))
    return tracks


class TrackLabels:
    """Labels from tracks, interpolated to the stamps of the depth images."""

    def __init__(
        self, tracks: Sequence[BodyTrack], transforms: TransformHistory, settings: LabelSettings
    ) -> None:
        """Use `tracks`, whose frames are found in the camera's frame by `transforms`."""
        self._tracks = tracks
        self._transforms = transforms
        self._settings = settings
        self._without_pose: dict[str, int] = defaultdict(int)
        self._camera = ''

    @property
    def warnings(self) -> Sequence[str]:
        """A sentence for each reason why labels are missing."""
        return [
            f'{count} labels were left out: the pose of {frame_id} in {self._camera} is unknown '
            'at their time; record /tf and /tf_static, or give it with --extrinsic'
            for frame_id, count in self._without_pose.items()
        ]

    def at(self, number: int, frame: Frame) -> Skeletons:  # noqa: ARG002 - stamps are enough
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        found: dict[int, NDArray[np.float64]] = {}
        moment = frame.stamp - self._settings.time_offset
        self._camera = frame.frame_id
        for track in self._tracks:
            place = bracket(track.stamps, moment, self._settings.longest_gap)
            if place is None:
                continue
            pose = self._pose(track.frame_id, frame)
            if pose is not None:
                positions = pose.apply(between(track.positions, place))
                found[track.body] = finished(positions, self._settings)
        return skeletons_of(found)

    def why_none(self, number: int, frame: Frame) -> str:  # noqa: ARG002
        """Return why a frame has no label; as `LabelSource.why_none`."""
        moment = frame.stamp - self._settings.time_offset
        gap = self._settings.longest_gap
        near = [track for track in self._tracks if bracket(track.stamps, moment, gap) is not None]
        if near:
            posed = any(self._find_pose(track.frame_id, frame) is not None for track in near)
            return NOWHERE if posed else 'at whose time the pose of the labels is unknown'
        if all(moment < track.stamps[0] for track in self._tracks):
            return 'before the first label'
        if all(moment > track.stamps[-1] for track in self._tracks):
            return 'after the last label'
        return f'in a gap of more than {gap * 1e-9:g} s between labels'

    def _pose(self, frame_id: str, frame: Frame) -> Pose | None:
        pose = self._find_pose(frame_id, frame)
        if pose is None:
            self._without_pose[frame_id] += 1
        return pose

    def _find_pose(self, frame_id: str, frame: Frame) -> Pose | None:
        if frame_id == CAMERA_FRAME or frame_id.lstrip('/') == frame.frame_id.lstrip('/'):
            return IDENTITY
        return self._transforms.lookup(frame.frame_id, frame_id, frame.stamp)


def finished(positions: NDArray[np.float64], settings: LabelSettings) -> NDArray[np.float64]:
    """Return the joints of one body in the camera's frame as labels, shape (20, 3)."""
    known = known_positions(positions)
    return settings.vocabulary.with_offsets(known) if settings.with_offsets else known


def skeletons_of(bodies: dict[int, NDArray[np.float64]]) -> Skeletons:
    """Return bodies, the joints of each of shape (20, 3), as skeletons; all NaN is left out."""
    possible = {body: known_positions(bodies[body]) for body in sorted(bodies)}
    known = {
        body: positions
        for body, positions in possible.items()
        if np.isfinite(positions).all(axis=1).any()
    }
    positions = np.array(list(known.values()), np.float32).reshape(-1, len(JOINT_NAMES), 3)
    positions[~np.isfinite(positions).all(axis=-1)] = np.nan
    return Skeletons(
        np.array(list(known), np.uint16),
        ALL_JOINTS,
        positions,
        np.asarray(np.isfinite(positions).all(axis=-1), np.float32),
    )
