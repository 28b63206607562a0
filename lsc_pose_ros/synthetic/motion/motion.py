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

"""Sampled motion of synthetic people: independent poses, or smooth motion through key poses.

Poses and transitions in which a limb penetrates the body are rejected and sampled again.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody
from lsc_pose_ros.synthetic.body.bone_rotations import pose_rotations
from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    CollisionBody,
    deepest_penetration,
    fit_collision_body,
)
from lsc_pose_ros.synthetic.geometry.rotation_kernels import about_x, about_y
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.joint_angles import (
    arms_to_cartesian,
    arms_to_polar,
    within_limits,
)
from lsc_pose_ros.synthetic.motion.lower_body_poses import (
    AFOOT_KINDS,
    LYING_KINDS,
    SEATED_KINDS,
    BodyPose,
    LowerBodyKinds,
)
from lsc_pose_ros.synthetic.motion.whole_body_poses import (
    pose_penetration,
    sample_gesture,
    sample_pose,
)
from lsc_pose_ros.synthetic.sampling import RandomStream

KEY_SECONDS = (0.35, 0.9)
"""The shortest and the longest time between key poses, unless large changes take longer."""

FASTEST = np.radians(250)
"""Largest mean angular speed between two key poses, radians per second."""

_TURNING = np.radians(40)  # a second
_TRIES = 12  # poses that are sampled before the best is taken
_CHECKS = 6  # poses on each transition that are tested
_OUTSIDE = np.radians(10)
_STRIDE_KEYS = 10
_FIRST_STEPS = 4


class RestingFractions(NamedTuple):
    """Fractions of the people who do not stand on their feet.

    Attributes:
        seated: on a seat.
        lying: on a bed, a sofa or the floor.
    """

    seated: float
    lying: float


class Motion(NamedTuple):
    """A person's motion in T frames.

    Attributes:
        rotations: the bones' rotations relative to their parents, for `pose_body`, shape
            (T, B, 3, 3). The root's rotation includes no yaw: the person roughly faces +z.
        yaw: the direction that the person faces, radians, 0 towards the camera, positive to the
            person's left, shape (T,).
        seated: whether the person sits on a seat, shape (T,); None if that is unknown.
        lying: whether the person lies, shape (T,); None if that is unknown.
    """

    rotations: NDArray[np.float64]
    yaw: NDArray[np.float64]
    seated: NDArray[np.bool_] | None = None
    lying: NDArray[np.bool_] | None = None


def sample_motion(
    body: BodyModel,
    rest: RestBody,
    count: int,
    rate: float | None,
    widest_yaw: float,
    random: np.random.Generator,
    *,
    fractions: RestingFractions | None = None,
) -> Motion:
    """Sample a person's motion in `count` frames.

    Args:
        body: the body model.
        rest: the person in the rest pose.
        count: number of frames.
        rate: frames per second; None samples independent poses.
        widest_yaw: largest absolute yaw, radians.
        random: the source of randomness.
        fractions: of poses or, with a rate, of people who rest; None samples the usual poses.

    Returns:
        The motion; with a rate its velocity is continuous.
    """
    collision_body = fit_collision_body(body, rest)
    if rate is None:
        kinds = [_sample_kinds(fractions, random) for _ in range(count)]
        poses = [_sample_any_pose(collision_body, random, each) for each in kinds]
        kind_of = [pose.kind for pose in poses]
        angles = np.array([pose.angles for pose in poses])
        yaw = widest_yaw * (2 * random.random(count) - 1)
    else:
        keys = _KeyPoses(collision_body, random, _sample_kinds(fractions, random))
        angles, yaw = _sample_smooth(keys, np.arange(count) / rate, widest_yaw, random)
        kind_of = [keys.resting or ''] * count
    rotations = pose_rotations(collision_body.rig, angles)
    lying = np.array([kind == 'lie' for kind in kind_of])
    if lying.any():
        _lay_down(rotations, lying, 1 if rate else count, random)
    return Motion(rotations, yaw, np.array([kind == 'sit' for kind in kind_of]), lying)


def _sample_kinds(
    fractions: RestingFractions | None, random: np.random.Generator
) -> LowerBodyKinds | None:
    if fractions is None:
        return None
    chosen = random.random()
    if chosen < fractions.seated:
        return SEATED_KINDS
    return LYING_KINDS if chosen < fractions.seated + fractions.lying else AFOOT_KINDS


def _lay_down(
    rotations: NDArray[np.float64],
    lying: NDArray[np.bool_],
    count: int,
    random: np.random.Generator,
) -> None:
    """Turn the roots of people who lie, in place, by one rotation or by one per frame."""
    turns = np.array([_lying_rotation(RandomStream(random)) for _ in range(count)])
    rotations[lying, 0] = (turns @ rotations[:, 0])[lying]


def _lying_rotation(stream: RandomStream) -> NDArray[np.float64]:
    """Return the rotation that lays a standing person on the back, a side or the front, (3, 3)."""
    roll = stream.choose(((0.5, 0.0), (0.18, 90.0), (0.17, -90.0), (0.15, 180.0)))
    upright = about_y(np.radians(stream.normal(roll, 14)))
    return about_x(np.radians(stream.normal(-90, 4))) @ upright


def interpolate_keys(
    times: NDArray[np.float64], key_times: NDArray[np.float64], keys: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate `keys`, shape (K, A), K > 1, at `times`, shape (T,).

    Cubic Hermite polynomials. The slope at a key is the weighted harmonic mean of the slopes on
    both sides, or zero at an extremum (Fritsch and Butland, 1984). Values stay within the range of
    the two adjacent keys, so they keep all limits that the keys keep.
    """
    spans = np.diff(key_times)[:, None]
    secants = np.diff(keys, axis=0) / spans
    before, after = secants[:-1], secants[1:]
    weight = (spans[:-1] + 2 * spans[1:]) / (3 * (spans[:-1] + spans[1:]))
    onwards = before * after > 0
    mean = np.where(onwards, weight * after + (1 - weight) * before, 1.0)
    slopes = np.zeros_like(keys)
    slopes[1:-1] = np.where(onwards, before * after / mean, 0.0)
    last = np.clip(np.searchsorted(key_times, times, side='right') - 1, 0, len(keys) - 2)
    span = spans[last]
    u = np.clip((times[:, None] - key_times[last, None]) / span, 0.0, 1.0)
    blend = u * u * (3 - 2 * u)
    values: NDArray[np.float64] = (
        keys[last]
        + blend * (keys[last + 1] - keys[last])
        + span * u * (1 - u) * ((1 - u) * slopes[last] - u * slopes[last + 1])
    )
    return values


def _sample_smooth(
    keys: '_KeyPoses',
    times: NDArray[np.float64],
    widest_yaw: float,
    random: np.random.Generator,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angles, shape (T, A), and yaw, (T,), at `times`, shape (T,)."""
    while len(keys.times) < 2 or keys.times[-1] < times[-1]:
        keys.extend()
    key_times = np.array(keys.times)
    yaws = _key_yaws(key_times, widest_yaw, random)
    path = interpolate_keys(
        times, key_times, arms_to_cartesian(np.array([pose.angles for pose in keys.poses]))
    )
    yaw = interpolate_keys(times, key_times, yaws[:, None])[:, 0]
    return within_limits(arms_to_polar(path)), yaw


def _key_yaws(
    times: NDArray[np.float64], widest: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Sample the yaw at each key: uniform at first, then with small changes."""
    changes = 2 * random.random(len(times)) - 1
    yaws = [widest * changes[0]]
    for change, span in zip(changes[1:], np.diff(times), strict=True):
        yaws.append(float(np.clip(yaws[-1] + _TURNING * span * change, -widest, widest)))
    return np.array(yaws)


def _sample_any_pose(
    collision_body: CollisionBody, random: np.random.Generator, kinds: LowerBodyKinds | None
) -> BodyPose:
    """Sample a pose that is independent of the previous one."""
    return _sample_clear_pose(
        collision_body, None, lambda stream: sample_pose(collision_body, stream, kinds), random
    )


def _sample_clear_pose(
    collision_body: CollisionBody,
    before: NDArray[np.float64] | None,
    sample: Callable[[RandomStream], BodyPose],
    random: np.random.Generator,
) -> BodyPose:
    """Sample a pose that can be reached from the previous one, if any, without self-collision.

    If no try is free of collisions, the one with the least penetration is returned.
    """
    sampled: list[tuple[float, BodyPose]] = []
    for _ in range(_TRIES):
        pose = sample(RandomStream(random))
        if before is None:
            depth = pose_penetration(collision_body, pose)
        else:
            depth = _path_penetration(collision_body, before, pose.angles)
        if depth <= MAX_PENETRATION:
            return pose
        sampled.append((depth, pose))
    return min(sampled, key=lambda each: each[0])[1]


def _path_penetration(
    collision_body: CollisionBody, before: NDArray[np.float64], after: NDArray[np.float64]
) -> float:
    """Return how deep limbs penetrate the body between two poses, metres.

    It is infinite if an arm would leave the limits of its joints.
    """
    start, end = arms_to_cartesian(before), arms_to_cartesian(after)
    path = arms_to_polar(start + np.linspace(0, 1, _CHECKS + 1)[1:, None] * (end - start))
    if np.abs(within_limits(path) - path).max() > _OUTSIDE:
        return np.inf
    # Rounded, so that the last bits, which differ between libraries, do not decide.
    return round(float(deepest_penetration(collision_body, path).max()), 6)


class _KeyPoses:
    """A sequence of key poses with their times; people who sit on a seat or lie stay so."""

    def __init__(
        self,
        collision_body: CollisionBody,
        random: np.random.Generator,
        kinds: LowerBodyKinds | None,
    ) -> None:
        self._collision_body = collision_body
        self._random = random
        self._kinds = kinds
        self.resting = {SEATED_KINDS: 'sit', LYING_KINDS: 'lie'}.get(kinds or ())
        self.times = [0.0]
        self.poses = [_sample_any_pose(collision_body, random, kinds)]

    def extend(self) -> None:
        """Append the key poses of a random action."""
        stream = RandomStream(self._random)
        actions = (
            (0.4, self._gesture), (0.2, self._repeat), (0.28, self._move), (0.12, self._walk),
        )  # fmt: skip
        stream.choose(actions[:2] if self.resting else actions)(stream)

    def _add(self, pose: BodyPose, seconds: float) -> None:
        change = np.abs(
            arms_to_cartesian(pose.angles) - arms_to_cartesian(self.poses[-1].angles)
        ).max()
        self.times.append(self.times[-1] + max(seconds, float(change) / FASTEST))
        self.poses.append(pose)

    def _next(self, sample: Callable[[CollisionBody, RandomStream], BodyPose]) -> BodyPose:
        return _sample_clear_pose(
            self._collision_body,
            self.poses[-1].angles,
            lambda stream: sample(self._collision_body, stream),
            self._random,
        )

    def _sample_gesture(self, collision_body: CollisionBody, stream: RandomStream) -> BodyPose:
        return sample_gesture(collision_body, self.poses[-1], stream)

    def _sample_pose(self, collision_body: CollisionBody, stream: RandomStream) -> BodyPose:
        return sample_pose(collision_body, stream, self._kinds)

    def _gesture(self, stream: RandomStream) -> None:
        self._add(self._next(self._sample_gesture), stream.between(*KEY_SECONDS))

    def _move(self, stream: RandomStream) -> None:
        self._add(self._next(self._sample_pose), stream.between(*KEY_SECONDS))

    def _repeat(self, stream: RandomStream) -> None:
        """Alternate between this and another gesture a few times, as in waving or clapping."""
        here, there = self.poses[-1], self._next(self._sample_gesture)
        seconds = stream.between(0.2, 0.6)
        for _ in range(int(stream.between(1, 4))):
            self._add(there, seconds)
            self._add(here, seconds)

    def _walk(self, stream: RandomStream) -> None:
        """Walk or run some strides; a stride takes about 1.1 s walking and 0.7 s running."""
        running = stream.choose(((0.6, 0.0), (0.2, 0.5), (0.2, 1.0)))
        size, hand = stream.between(0.7, 1.15), np.radians(stream.normal(0, 10))
        count = int(_STRIDE_KEYS * stream.between(1, 3))
        seconds_per_key = (1.1 - 0.4 * running) * stream.between(0.9, 1.15) / _STRIDE_KEYS

        def at(phase: float) -> BodyPose:
            angles = stride_angles(phase % 1.0, running, size, hand)
            return BodyPose('walk', within_limits(angles))

        # Start with the phase that is easiest to reach.
        before = self.poses[-1].angles
        first = min(
            (stream.uniform() for _ in range(_FIRST_STEPS)),
            key=lambda phase: _path_penetration(self._collision_body, before, at(phase).angles),
        )
        self._add(at(first), stream.between(*KEY_SECONDS))
        for key in range(1, count):
            self._add(at(first + key / _STRIDE_KEYS), seconds_per_key)
