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

"""Hands that touch the person's own body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import bone_heads, bone_orientations
from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    CollisionBody,
    pair_penetrations,
)
from lsc_pose_ros.synthetic.geometry.rotation_kernels import rotated, rotated_back
from lsc_pose_ros.synthetic.motion.arm_reaching import FINGERS, MIRROR, move_hand
from lsc_pose_ros.synthetic.motion.inverse_kinematics import REACH_TOLERANCE, align_palm
from lsc_pose_ros.synthetic.motion.joint_angles import ARMS
from lsc_pose_ros.synthetic.sampling import RandomStream


class TouchTarget(NamedTuple):
    """A target on the person's own body.

    Attributes:
        part: the name of capsules; `other_` marks those of the other side, `own_` of the same.
        which: which of several capsules of this name, counted from the pelvis or the trunk.
        along: range of the position along the capsule's axis, 0 to 1.
        outwards: direction out of the body in the rest pose for the left hand: left, up, forwards.
        scatter: standard deviation of each component of `outwards`.
    """

    part: str
    which: int
    along: tuple[float, float]
    outwards: tuple[float, float, float]
    scatter: float = 0.35


TOUCH_TARGETS: tuple[tuple[float, TouchTarget], ...] = (
    (0.14, TouchTarget('head', 0, (0, 1), (0.8, 0.0, 0.5), 0.5)),  # ear, cheek, chin, phone
    (0.06, TouchTarget('head', 0, (0.7, 1), (0.3, 1.0, 0.2), 0.5)),
    (0.04, TouchTarget('head', 0, (0.3, 1), (0.5, 0.1, -1.0))),
    (0.05, TouchTarget('neck', 0, (0, 1), (0.6, 0.0, -0.6), 0.5)),
    (0.13, TouchTarget('chest', 1, (0, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.06, TouchTarget('belly', 0, (0, 1), (0.5, 0.0, 1.0), 0.4)),
    (0.06, TouchTarget('belly', 1, (0, 1), (0.3, 0.1, 1.0), 0.4)),
    (0.12, TouchTarget('hips', 0, (1, 1), (0.9, 0.2, 0.2), 0.4)),
    (0.08, TouchTarget('other_upper_arm', 0, (0, 1), (0.0, 0.3, 1.0), 0.4)),
    (0.08, TouchTarget('other_upper_arm', 1, (0.5, 1), (0.0, 0.3, 1.0), 0.4)),
    (0.06, TouchTarget('other_forearm', 1, (0, 1), (0.3, 0.5, 0.5), 0.6)),
    (0.05, TouchTarget('own_thigh', 1, (0, 0.6), (0.5, 0.0, 1.0), 0.4)),
    (0.04, TouchTarget('own_thigh', 1, (0.8, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.03, TouchTarget('other_thigh', 1, (0.5, 1), (0.0, 0.2, 1.0), 0.3)),
)  # fmt: skip
SITTING_TOUCH_TARGETS: tuple[tuple[float, TouchTarget], ...] = (
    (0.4, TouchTarget('own_thigh', 1, (0.1, 0.8), (0.2, 0.0, 1.0), 0.3)),
    (0.3, TouchTarget('own_thigh', 1, (0.8, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.1, TouchTarget('other_thigh', 1, (0.3, 1), (0.0, 0.1, 1.0), 0.3)),
    (0.1, TouchTarget('own_shank', 0, (0, 0.6), (0.3, 0.0, 1.0), 0.3)),
    (0.1, TouchTarget('own_shank', 1, (0.4, 1), (0.4, 0.0, 1.0), 0.4)),
)


_TOUCH_TRIES = (0.0, -25.0, 25.0, 50.0, 75.0)
"""Increments of the elbow's swivel that are tried until nothing collides, degrees."""


def touch_body(
    collision_body: CollisionBody,
    angles: NDArray[np.float64],
    side: int,
    target: TouchTarget,
    stream: RandomStream,
) -> None:
    """Lay a hand, 0 is the left, on the body, in place; if that is impossible, let it hang."""
    rig, capsules = collision_body
    position, inwards = _touch_point(collision_body, angles, side, target, stream)
    swivel = stream.normal(25, 25)
    closed = np.radians(stream.normal(20, 10))
    hanging = angles[ARMS[side]].copy()
    for more in _TOUCH_TRIES:
        arm = hanging.copy()
        if move_hand(rig, arm, position, np.radians(swivel + more)) > REACH_TOLERANCE:
            continue
        align_palm(arm, inwards)
        arm[FINGERS] = closed
        angles[ARMS[side]] = arm
        # Rounded, so that the last bits, which differ between libraries, do not decide.
        if round(float(pair_penetrations(rig, capsules, angles).max()), 6) < MAX_PENETRATION:
            return
    angles[ARMS[side]] = hanging


def _touch_point(
    collision_body: CollisionBody,
    angles: NDArray[np.float64],
    side: int,
    target: TouchTarget,
    stream: RandomStream,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the target position of a hand, 0 is the left, and the direction into the body.

    Both are in the chest's frame, mirrored for the right hand.
    """
    rig, capsules = collision_body
    mirror = MIRROR if side else np.ones(3)
    number = capsule_number(capsules.names, target, side)
    fraction = stream.between(*target.along)
    out = mirror * [stream.normal(mean, target.scatter) for mean in target.outwards]
    start, end = capsules.ends[number]
    if (end - start)[0] * mirror[0] < 0:  # in lateral capsules, 1 is the end on the hand's side
        start, end = end, start
    along = end - start
    if '_' in target.part:  # in limbs, the direction is orthogonal to the axis
        out -= (out * along).sum() / max((along**2).sum(), 1e-9) * along
    out /= max(np.sqrt((out**2).sum()), 1e-6)
    hand = capsules.radii[capsules.names.index(f'{"LR"[side]}_hand')]
    surface = start + fraction * along + (capsules.radii[number] + 1.6 * hand) * out
    orientations = bone_orientations(angles, rig.standing, rig.parts)
    heads = bone_heads(orientations, rig.parents, rig.heads)
    bone, chest = capsules.bones[number], rig.numbers['spine01']
    position = heads[bone] + rotated(orientations[bone], surface) - heads[chest]
    return (
        mirror * rotated_back(orientations[chest], position),
        -mirror * rotated_back(orientations[chest], rotated(orientations[bone], out)),
    )


def capsule_number(names: tuple[str, ...], target: TouchTarget, side: int) -> int:
    """Return the number of the capsule that a hand, 0 is the left, touches."""
    if target.part.startswith('other_'):
        name = f'{"RL"[side]}_{target.part.removeprefix("other_")}'
    elif target.part.startswith('own_'):
        name = f'{"LR"[side]}_{target.part.removeprefix("own_")}'
    else:
        name = target.part
    found = [number for number, candidate in enumerate(names) if candidate == name]
    return found[target.which]
