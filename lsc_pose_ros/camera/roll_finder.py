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

"""Finds the roll of a camera: from the setting, or from a gravity-aligned frame of the tree."""

import math

from lsc_pose_ros.camera.roll import RIGHT_ANGLE
from lsc_pose_ros.camera.transform_tree import TransformTree

# The frames of REP-105 whose z axis points up, and the usual name of the simulators' root.
_GRAVITY_FRAMES = frozenset({'base_link', 'base_footprint', 'odom', 'map', 'world'})

# Nearer to the vertical than this, the viewing axis leaves the roll undefined: the least length of
# the upward direction in the image plane.
_LEAST_UPWARD = 0.35

# Nearer than this to the middle between two multiples of 90 degrees, the roll is ambiguous.
_AMBIGUOUS = 10.0


class RollFinder:
    """Returns the roll of the camera for each frame.

    Attributes:
        tree: the tree of frames; add transforms as they come.
        choice: which roll was taken, and why.
        warning: a sentence if the roll is ambiguous, otherwise ''.
        way: the frames from that of the camera up to the gravity-aligned one; empty if there is
            none.
    """

    def __init__(self, roll: int | None, gravity_frame: str = '') -> None:
        """Start without transforms.

        Args:
            roll: 0, 90, 180 or 270 degrees; None to find it.
            gravity_frame: a frame whose z axis points up; '' for those of REP-105.
        """
        self.tree = TransformTree()
        self.choice = ''
        self.warning = ''
        self.way: tuple[str, ...] = ()
        self._given = roll
        self._gravity_frame = gravity_frame.lstrip('/')
        self._roll = 0
        self._found_for: tuple[str, int] | None = None
        if roll is not None:
            self.choice = f'camera_roll {roll}'

    def find(self, frame_id: str) -> int:
        """Return the roll of the camera with this optical frame, degrees.

        Without a known way to a gravity-aligned frame it is 0, or the one before.
        """
        if self._given is not None:
            return self._given
        key = frame_id, self.tree.version
        if key != self._found_for:
            self._found_for = key
            self._find(frame_id)
        return self._roll

    def _find(self, frame_id: str) -> None:
        way = [frame_id.lstrip('/')]
        for ancestor, rotation in self.tree.ancestors(frame_id):
            way.append(ancestor)
            if self._is_gravity_aligned(ancestor):
                self.way = tuple(way)
                # The third row is the upward direction in the optical frame.
                self._take(frame_id, ancestor, *map(float, rotation[2, :2]))
                return
        self.way = ()
        wanted = self._gravity_frame or 'gravity-aligned frame (base_link, odom, map, ...)'
        missing = f'no transform from {frame_id:.100} to a {wanted}'
        self.choice = f'camera_roll auto: {self._roll}, {missing}'

    def _is_gravity_aligned(self, frame: str) -> bool:
        if self._gravity_frame:
            return frame == self._gravity_frame
        return frame.rpartition('/')[2] in _GRAVITY_FRAMES

    def _take(self, frame_id: str, ancestor: str, right: float, down: float) -> None:
        angle = math.degrees(math.atan2(-right, -down)) % 360
        nearest = round(angle / RIGHT_ANGLE) * RIGHT_ANGLE
        distance = abs(angle - nearest)
        way = f'transform from {frame_id:.100} to {ancestor:.100}'
        if math.hypot(right, down) < _LEAST_UPWARD or distance > RIGHT_ANGLE / 2 - _AMBIGUOUS:
            self.warning = (
                f'camera_roll auto: by the {way}, the camera is turned by {angle:.0f} degrees or '
                f'looks nearly straight up or down, or {frame_id:.100} is no optical frame '
                f'(REP-103); {self._roll} is taken. Set camera_roll'
            )
            self.choice = f'camera_roll auto: {self._roll}, ambiguous by the {way}'
            return
        self._roll = nearest % 360
        self.choice = f'camera_roll auto: {self._roll}, by the {way}'
