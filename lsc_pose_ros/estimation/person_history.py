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

A body is the person of the frame before who was nearest to it. Numbers do not matter: many
segmentations number the bodies anew in each frame.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.image_arguments import ImageArguments, check_images
from lsc_pose_ros.estimation.joint_filter import FilteredJoints, filter_joints, measured_joints
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.forest.body_yaw_tracking import BodyYawBelief
from lsc_pose_ros.pose.inference.past import Past

LONGEST_GAP_NS = 500_000_000
"""After a longer time nothing is expected of a person, nanoseconds."""

GATE = 0.4
"""The largest distance between a body and the person's last place, metres."""

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

STRIDE = 3
"""Each so many rows and columns tell where a body is."""


class Person(NamedTuple):
    """What is known of a person after a frame.

    Attributes:
        stamp: nanoseconds.
        place: the mean of the visible surface, metres, shape (3,).
        joints: the filtered joints.
        velocity: metres per second, 0 if unknown, shape (J, 3).
        confidence: of the joints, shape (J,).
        body_yaw: what is known of the body yaw.
        frames: how many frames ago all body yaws were tried.
    """

    stamp: int
    place: NDArray[np.float64]
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
        self._places: dict[int, NDArray[np.float64]] = {}

    def begin(
        self,
        stamp: int,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
    ) -> None:
        """Begin a frame: find out who its bodies are.

        Args:
            stamp: nanoseconds. After a gap, or a stamp that goes back, nobody is known.
            depth: metres, 0 if unknown, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.

        Raises:
            InputError: an argument has another type or shape.
        """
        people = {id(person): person for person in (*self._before, *self._now)}
        self._before = [
            person for person in people.values() if 0 < stamp - person.stamp <= LONGEST_GAP_NS
        ]
        self._stamp, self._now = stamp, []
        images = check_images(depth, labels, camera)
        self._places = places_of(images)
        self._matched = nearest_people(self._places, self._before)

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
        place, before = self._places.get(body.number), self._matched.get(body.number)
        if place is None:
            return body.joints
        velocity, frames = np.zeros_like(body.joints), 0
        if before is not None:
            self._before = [person for person in self._before if person is not before]
        if before is not None and body.past is not None:
            seconds = (self._stamp - before.stamp) * 1e-9
            expected = FilteredJoints(body.past.joints, before.joints.variance)
            joints = filter_joints(expected, seconds, joints)
            moved = (joints.positions - before.joints.positions) / np.float32(seconds)
            velocity = np.where(np.isfinite(moved), moved, np.float32(0))
            frames = 0 if body.past.all_round else before.frames + 1
        self._now.append(
            Person(self._stamp, place, joints, velocity, body.confidence, body.body_yaw, frames)
        )
        return joints.positions


def nearest_people(
    places: dict[int, NDArray[np.float64]], people: list[Person]
) -> dict[int, Person]:
    """Return the person that each body is, by the body's number; the nearest pairs first.

    Args:
        places: of the bodies, metres, by number.
        people: who are known.
    """
    pairs = sorted(
        (distance, number, index)
        for number, place in places.items()
        for index, person in enumerate(people)
        if (distance := float(np.linalg.norm(place - person.place))) <= GATE
    )
    matched: dict[int, Person] = {}
    taken: set[int] = set()
    for _, number, index in pairs:
        if number not in matched and index not in taken:
            matched[number] = people[index]
            taken.add(index)
    return matched


def places_of(
    images: ImageArguments,
) -> dict[int, NDArray[np.float64]]:
    """Return the mean of the visible surface of each body, metres, by the body's number."""
    depth, labels, camera = images
    numbers = np.unique(labels[::STRIDE, ::STRIDE])
    numbers = numbers[numbers >= 0]
    sums = sum_points(depth, labels, image_rays(camera, *depth.shape), numbers)
    return {
        int(number): row[:3] / row[3]
        for number, row in zip(numbers, sums, strict=True)
        if row[3] > 0
    }


@kernel
def sum_points(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    rays: ImageRays,
    numbers: NDArray[np.int32],
) -> NDArray[np.float64]:
    """Return the sums of x, y, z and 1 over the points of each body, shape (B, 4).

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        labels: the body number of each pixel, shape (H, W).
        rays: of the pixels.
        numbers: of the bodies, ascending, shape (B,).
    """
    sums = np.zeros((numbers.shape[0], 4))
    for row in range(0, depth.shape[0], STRIDE):
        for column in range(0, depth.shape[1], STRIDE):
            z = depth[row, column]
            if labels[row, column] < 0 or not 0 < z < np.inf:
                continue
            body = np.searchsorted(numbers, labels[row, column])
            sums[body, 0] += z * rays.right[row + 1, column + 1]
            sums[body, 1] += z * rays.down[row + 1, column + 1]
            sums[body, 2] += z
            sums[body, 3] += 1
    return sums
