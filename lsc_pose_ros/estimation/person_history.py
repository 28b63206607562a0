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


"""Knows the people of the frames before: what is expected of each body of the next frame.

A body is the person of the frames before who is expected nearest to it. Numbers do not matter:
many segmentations number the bodies anew in each frame.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.estimation.joint_filter import FilteredJoints, filter_joints, measured_joints
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.forest.body_yaw_tracking import BodyYawBelief
from lsc_pose_ros.pose.inference.past import Past
from lsc_pose_ros.tracking.assignment import assign
from lsc_pose_ros.tracking.movement import LARGEST_COST, Movement, at_rest
from lsc_pose_ros.tracking.surfaces import Surface

LONGEST_GAP_NS = 500_000_000
"""After a longer time nothing is expected of a person, nanoseconds."""

FRAME_TIME = 1 / 30
REACH = 0.1
"""A joint moves about so far in FRAME_TIME, metres; in other times by the root of their ratio."""

LARGEST_REACH = 0.3
"""The largest reach, metres."""

TREND = 0.5
"""This fraction of the last movement is expected to go on."""

LARGEST_STEP = 0.15
"""No joint is expected to move farther than this between two frames, metres."""

ALL_ROUND_EVERY = 15
"""All body yaws are tried again after so many frames."""


class Person(NamedTuple):
    """What is known of a person after a frame.

    Attributes:
        stamp: nanoseconds.
        movement: of the visible surface.
        joints: the filtered joints.
        velocity: metres per second, 0 if unknown, shape (J, 3).
        confidence: of the joints, shape (J,).
        body_yaw: what is known of the body yaw.
        frames: how many frames ago all body yaws were tried.
    """

    stamp: int
    movement: Movement
    joints: FilteredJoints
    velocity: NDArray[np.float32]
    confidence: NDArray[np.float32]
    body_yaw: BodyYawBelief | None
    frames: int


class PersonHistory:
    """Remembers people from frame to frame; a `Memory` of the estimator."""

    def __init__(self) -> None:
        """Know nobody."""
        self._stamp = 0
        self._before: list[Person] = []
        self._now: list[Person] = []
        self._matched: dict[int, Person] = {}
        self._surfaces: Mapping[int, Surface] = {}

    def begin(self, stamp: int, surfaces: Mapping[int, Surface]) -> None:
        """Begin a frame: find out who its bodies are.

        Args:
            stamp: nanoseconds. After a gap, or a stamp that goes back, nobody is known.
            surfaces: of its bodies, by number.
        """
        people = {id(person): person for person in (*self._before, *self._now)}
        self._before = [
            person for person in people.values() if 0 < stamp - person.stamp <= LONGEST_GAP_NS
        ]
        self._stamp, self._now = stamp, []
        self._surfaces = surfaces
        self._matched = people_of(stamp, surfaces, self._before)

    def recall(self, number: int) -> Past | None:
        """Return what is expected of a body of this frame; None if it is nobody known."""
        person = self._matched.get(number)
        if person is None:
            return None
        seconds = (self._stamp - person.stamp) * 1e-9
        step = TREND * seconds * person.velocity
        length = np.linalg.norm(step, axis=1, keepdims=True)
        step *= np.minimum(1, LARGEST_STEP / np.maximum(length, 1e-6))
        return Past(
            (person.joints.positions + step).astype(np.float32),
            person.confidence,
            float(min(REACH * np.sqrt(seconds / FRAME_TIME), LARGEST_REACH)),
            person.body_yaw,
            person.frames >= ALL_ROUND_EVERY,
        )

    def remember(self, body: BodyEstimate) -> NDArray[np.float32]:
        """Keep the estimate of a body of this frame, and return its joints, filtered.

        Returns:
            metres, NaN if not estimated, shape (J, 3).
        """
        joints = measured_joints(body.joints, body.confidence)
        surface, before = self._surfaces.get(body.number), self._matched.get(body.number)
        if surface is None:
            return body.joints
        movement = at_rest(self._stamp, surface)
        velocity, frames = np.zeros_like(body.joints), 0
        if before is not None:
            self._before = [person for person in self._before if person is not before]
            movement = before.movement.seen(self._stamp, surface)
        if before is not None and body.past is not None:
            seconds = (self._stamp - before.stamp) * 1e-9
            expected = FilteredJoints(body.past.joints, before.joints.variance)
            joints = filter_joints(expected, seconds, joints)
            moved = (joints.positions - before.joints.positions) / np.float32(seconds)
            velocity = np.where(np.isfinite(moved), moved, np.float32(0))
            frames = 0 if body.past.all_round else before.frames + 1
        self._now.append(
            Person(self._stamp, movement, joints, velocity, body.confidence, body.body_yaw, frames)
        )
        return joints.positions


def people_of(
    stamp: int, surfaces: Mapping[int, Surface], people: Sequence[Person]
) -> dict[int, Person]:
    """Return the person that each body is, by the body's number; the least likely are nobody.

    Args:
        stamp: nanoseconds.
        surfaces: of the bodies, by number.
        people: who are known.
    """
    numbers = list(surfaces)
    costs = np.array(
        [
            [person.movement.cost(stamp, surfaces[number]) for person in people]
            for number in numbers
        ]
    ).reshape(len(numbers), len(people))
    return {numbers[row]: people[column] for row, column in assign(costs, LARGEST_COST)}
