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

"""The transforms of /tf over time, interpolated to any moment."""

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.rotation import rotation_matrix
from lsc_pose_ros.labels.interpolation import between, bracket, slerp
from lsc_pose_ros.labels.limits import FARTHEST
from lsc_pose_ros.messages.label_messages import StampedTransform

# Deeper trees are cycles.
_DEEPEST = 100


class Pose(NamedTuple):
    """The pose of one frame in another: x_parent = rotation x_child + translation.

    Attributes:
        rotation: shape (3, 3).
        translation: metres, shape (3,).
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]

    def apply(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return `points` of the child frame in the parent frame, shape (..., 3)."""
        return points @ self.rotation.T + self.translation

    def after(self, inner: 'Pose') -> 'Pose':
        """Return the pose in this pose's parent of what `inner` has in this pose's child."""
        return Pose(self.rotation @ inner.rotation, self.apply(inner.translation))

    def inverse(self) -> 'Pose':
        """Return the pose of the parent frame in the child frame."""
        return Pose(self.rotation.T, -self.translation @ self.rotation)


IDENTITY = Pose(np.eye(3), np.zeros(3))


class TransformHistory:
    """All transforms of a recording."""

    def __init__(self, longest_gap: int) -> None:
        """Start with no transforms.

        Args:
            longest_gap: the longest time between two transforms that is interpolated, nanoseconds.
        """
        self._longest_gap = longest_gap
        self._static: dict[str, tuple[str, Pose]] = {}
        self._moving: dict[str, dict[str, _Samples]] = defaultdict(dict)

    @property
    def frames(self) -> set[str]:
        """The names of all frames."""
        parents = {parent for parent, _ in self._static.values()}
        parents.update(parent for each in self._moving.values() for parent in each)
        return parents | set(self._static) | set(self._moving)

    def add(self, transform: StampedTransform, *, static: bool = False) -> None:
        """Add a transform; one with numbers that are not finite, or absurd, is left out."""
        numbers = np.array([*transform.translation, *transform.rotation])
        if not (np.abs(numbers) <= FARTHEST).all():  # NaN, too
            return
        length = float(np.linalg.norm(transform.rotation))
        if not length > 0:
            return
        child, parent = _plain(transform.child), _plain(transform.parent)
        rotation = np.array(transform.rotation) / length
        if static:
            self._static[child] = (
                parent,
                Pose(rotation_matrix(rotation), np.array(transform.translation)),
            )
            return
        samples = self._moving[child].setdefault(parent, _Samples())
        samples.add(transform.stamp, np.array(transform.translation), rotation)

    def forget(self, child: str) -> None:
        """Remove the transforms of a child frame."""
        self._static.pop(_plain(child), None)
        self._moving.pop(_plain(child), None)

    def lookup(self, target: str, source: str, moment: int) -> Pose | None:
        """Return the pose of frame `source` in frame `target`, or None if it is unknown then.

        Args:
            target: the name of the frame in which the pose is expressed.
            source: the name of the frame whose pose is returned.
            moment: nanoseconds.
        """
        above_target = self._ancestors(_plain(target), moment)
        above_source = self._ancestors(_plain(source), moment)
        for name, pose in above_source.items():
            if name in above_target:
                return above_target[name].inverse().after(pose)
        return None

    def _ancestors(self, frame: str, moment: int) -> dict[str, Pose]:
        """Return the pose of `frame` in itself and in each ancestor, the nearest first."""
        poses = {frame: IDENTITY}
        pose = IDENTITY
        for _ in range(_DEEPEST):
            step = self._parent(frame, moment)
            if step is None or step[0] in poses:
                break
            frame, pose = step[0], step[1].after(pose)
            poses[frame] = pose
        return poses

    def _parent(self, child: str, moment: int) -> tuple[str, Pose] | None:
        for parent, samples in self._moving.get(child, {}).items():
            pose = samples.at(moment, self._longest_gap)
            if pose is not None:
                return parent, pose
        return self._static.get(child)


class _Samples:
    """The poses of one child frame in one parent."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._translations: list[NDArray[np.float64]] = []
        self._rotations: list[NDArray[np.float64]] = []
        self._sorted = True

    def add(
        self, stamp: int, translation: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        self._sorted = self._sorted and (not self._stamps or stamp > self._stamps[-1])
        self._stamps.append(stamp)
        self._translations.append(translation)
        self._rotations.append(rotation)

    def at(self, moment: int, longest_gap: int) -> Pose | None:
        if not self._sorted:
            self._sort()
        place = bracket(self._stamps, moment, longest_gap)
        if place is None:
            return None
        first, second = self._rotations[place.before], self._rotations[place.after]
        rotation = rotation_matrix(slerp(first, second, place.fraction))
        return Pose(rotation, between(self._translations, place))

    def _sort(self) -> None:
        """Sort by stamp; of equal stamps, the last one counts."""
        latest = {stamp: index for index, stamp in enumerate(self._stamps)}
        order = [latest[stamp] for stamp in sorted(latest)]
        self._stamps = sorted(latest)
        self._translations = [self._translations[index] for index in order]
        self._rotations = [self._rotations[index] for index in order]
        self._sorted = True


def _plain(frame: str) -> str:
    return frame.lstrip('/')
