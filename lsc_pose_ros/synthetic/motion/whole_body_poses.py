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

"""Whole-body poses: the lower body, then arm gestures without self-collision."""

import numpy as np

from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    CollisionBody,
    deepest_penetration,
)
from lsc_pose_ros.synthetic.motion.arm_gestures import sample_arms
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ARMS, mirrored, within_limits
from lsc_pose_ros.synthetic.motion.lower_body_poses import (
    BodyPose,
    LowerBodyKinds,
    let_arms_hang,
    sample_lower_body,
)
from lsc_pose_ros.synthetic.sampling import RandomStream

_TRIES = 3  # for the arms of one stance


def sample_pose(
    collision_body: CollisionBody, stream: RandomStream, kinds: LowerBodyKinds | None = None
) -> BodyPose:
    """Sample a pose within the limits of the joints.

    In a few poses limbs still penetrate the body; see `deepest_penetration`.

    Args:
        collision_body: the person's rig and capsules.
        stream: the source of randomness.
        kinds: the kinds of poses of the lower body; None samples all of them.
    """
    is_mirrored = stream.bernoulli(0.5)
    lower_body = sample_lower_body(collision_body.rig, stream, kinds)
    pose = _with_arms(collision_body, lower_body, stream)
    return pose._replace(angles=mirrored(pose.angles)) if is_mirrored else pose


def sample_gesture(
    collision_body: CollisionBody, before: BodyPose, stream: RandomStream
) -> BodyPose:
    """Sample the next gesture: the legs stay, the trunk moves little, half the time one arm stays.

    Args:
        collision_body: the person's rig and capsules.
        before: the previous pose.
        stream: the source of randomness.
    """
    angles = before.angles.copy()
    let_arms_hang(angles)
    for name in ('bend', 'side', 'twist', 'nod', 'tilt', 'turn'):
        angles[ANGLE_NUMBERS[name]] += np.radians(stream.normal(0, 6))
    kept = stream.choose(((0.5, None), (0.25, 0), (0.25, 1)))
    kind = 'stand' if before.kind == 'walk' else before.kind
    pose = _with_arms(collision_body, BodyPose(kind, angles), stream)
    if kept is not None:
        pose.angles[ARMS[kept]] = before.angles[ARMS[kept]]
    return pose


def pose_penetration(collision_body: CollisionBody, pose: BodyPose) -> float:
    """Return how deep a pose's limbs penetrate the body, metres.

    It is rounded, so that the last bits, which differ between libraries, do not decide.
    """
    return round(float(deepest_penetration(collision_body, pose.angles[None])[0]), 6)


def _with_arms(
    collision_body: CollisionBody, lower_body: BodyPose, stream: RandomStream
) -> BodyPose:
    """Return `lower_body` with the first of a few arm gestures that has no self-collision."""
    for _ in range(_TRIES):
        pose = lower_body._replace(angles=within_limits(lower_body.angles))
        sample_arms(collision_body, pose, stream)
        pose = pose._replace(angles=within_limits(pose.angles))
        if pose_penetration(collision_body, pose) <= MAX_PENETRATION:
            break
    return pose
