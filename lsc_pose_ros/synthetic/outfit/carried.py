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

"""Loads that hang from a hand or that both hands carry; they are level, whatever the pose."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.skin_parts import NO_PART
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.shapes import Blocks, Mesh, box_mesh, join, rounded

_BETWEEN_HANDS = (0.15, 0.7)  # distances of hands that can carry a load, metres
_LEVEL = 0.15  # largest height difference between such hands, metres
_AHEAD = 0.12  # least distance of such hands from the trunk, metres
_PALM = 0.04  # from a hand's joint to the palm, metres
_LOAD, _HANGING = 0.5, 0.12  # probabilities, if the hands allow them


class Load(NamedTuple):
    """Something that a person carries, in the frame of the joints.

    Attributes:
        mesh: the surface, metres.
        parts: the body part of each triangle, shape (T,).
    """

    mesh: Mesh
    parts: NDArray[np.int32]


NOTHING = Load(join([]), np.full(0, NO_PART, np.int32))


class CarriedSize(NamedTuple):
    """Sizes of what a person carries if the hands allow it.

    Attributes:
        load: height and depth of the load between both hands, metres, or None.
        hanging: half sizes of the bag that hangs from a hand, metres, or None.
        hand: the hand that the bag hangs from: 'l' or 'r'.
    """

    load: tuple[float, float] | None
    hanging: tuple[float, float, float] | None
    hand: str


def sample_carried(stream: RandomStream) -> CarriedSize:
    """Sample what a person carries if the hands allow it."""
    load = (stream.between(0.04, 0.4), stream.between(0.1, 0.4))
    bag = (stream.between(0.1, 0.2), stream.between(0.12, 0.25), stream.between(0.04, 0.1))
    return CarriedSize(
        load if stream.bernoulli(_LOAD) else None,
        bag if stream.bernoulli(_HANGING) else None,
        'l' if stream.bernoulli(0.5) else 'r',
    )


def carried_load(
    size: CarriedSize, joints: NDArray[np.float64], down: NDArray[np.float64]
) -> Load:
    """Return what a person carries in a pose.

    Args:
        size: what the person carries if the hands allow it.
        joints: metres, shape (20, 3).
        down: the direction of gravity in the frame of the joints, shape (3,).
    """
    if size.load is not None:
        load = _between_hands(size.load, joints, down)
        if load is not None:
            return load
    if size.hanging is not None:
        return _hanging(size.hanging, size.hand, joints, down)
    return NOTHING


def _between_hands(
    size: tuple[float, float], joints: NDArray[np.float64], down: NDArray[np.float64]
) -> Load | None:
    """Return a box between both hands, half of it for each hand, or None."""
    left, right = joints[JOINT_NUMBERS['l_hand']], joints[JOINT_NUMBERS['r_hand']]
    apart = left - right
    lift = float(apart @ down)
    across = apart - lift * down
    width = float(np.sqrt((across**2).sum()))
    hips = joints[JOINT_NUMBERS['l_hip']] - joints[JOINT_NUMBERS['r_hip']]
    if not _BETWEEN_HANDS[0] < width < _BETWEEN_HANDS[1] or across @ hips <= 0:
        return None
    across /= width
    ahead = np.cross(across, -down)  # left x up
    middle = 0.5 * (left + right)
    reach = float((middle - joints[JOINT_NUMBERS['torso']]) @ ahead)
    if abs(lift) > _LEVEL or reach < _AHEAD:
        return None
    height, depth = size
    # The load ends before the trunk.
    forward = max(0.5 * depth - (reach - _AHEAD), 0.0)
    axes = np.stack([across, -down, ahead], axis=1)
    half = np.array([0.25 * max(width - 2 * _PALM, 0.06), 0.5 * height, 0.5 * depth])
    centres = np.array([middle + sign * half[0] * across + forward * ahead for sign in (1, -1)])
    mesh = box_mesh(Blocks(centres, np.stack([axes, axes]), np.stack([half, half])))
    hands = np.array([1 + JOINT_NUMBERS['l_hand'], 1 + JOINT_NUMBERS['r_hand']], np.int32)
    owners = mesh.triangles[:, 0] // (len(mesh.vertices) // 2)
    return Load(mesh, hands[owners])


def _hanging(
    half: tuple[float, float, float],
    side: str,
    joints: NDArray[np.float64],
    down: NDArray[np.float64],
) -> Load:
    """Return a bag that hangs from a hand that is lower than its elbow."""
    hand, elbow = joints[JOINT_NUMBERS[f'{side}_hand']], joints[JOINT_NUMBERS[f'{side}_elbow']]
    if (hand - elbow) @ down < 0.1:
        return NOTHING
    hips = joints[JOINT_NUMBERS['l_hip']] - joints[JOINT_NUMBERS['r_hip']]
    across = hips - (hips @ down) * down
    length = float(np.sqrt((across**2).sum()))
    if length == 0.0:
        return NOTHING
    across /= length
    # The bag is narrow across and long from front to back.
    axes = np.stack([np.cross(down, across), -down, across], axis=1)
    bag = rounded(half, 0.4)
    middle = hand + (half[1] + 0.08) * down
    mesh = Mesh(bag.vertices @ axes.T + middle, bag.triangles)
    return Load(mesh, np.full(len(mesh.triangles), 1 + JOINT_NUMBERS[f'{side}_hand'], np.int32))
