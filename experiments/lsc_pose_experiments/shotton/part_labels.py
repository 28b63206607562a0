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

"""The body part at each point of a person whose joints are known.

Shotton et al. learn from rendered people whose parts are painted on. Recordings label only
joints. So the part of a point is that of the nearest joint of the nearest bone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, default_edges
from lsc_pose_ros.numerics.jit import kernel

EXTENT = 0.1
"""A part extends this far from its joint along a bone, metres.

Points between two parts have the class NOT_A_PERSON. Without it, the middle of a part would be far
from its joint: the bones on both sides of a joint have different lengths.
"""

REACH = 0.3
"""Points farther than this from all bones have the class NOT_A_PERSON, metres."""

# Mean radii of adults' limbs, by the lower end of the bone, metres: a thigh is thick, so that a
# point on it may be nearer to the bones of the hand beside it than to its own.
_RADII = {
    'head': 0.09, 'torso': 0.12, 'pelvis': 0.12, 'shoulder': 0.07, 'elbow': 0.05, 'wrist': 0.04,
    'hand': 0.03, 'hip': 0.11, 'knee': 0.07, 'ankle': 0.05, 'foot': 0.04,
}  # fmt: skip
_OTHER_RADIUS = 0.05


class Bones(NamedTuple):
    """B bones; a joint without bones is a bone of length 0.

    Attributes:
        ends: the numbers of the joints at both ends, shape (B, 2).
        positions: of the ends, metres, shape (B, 2, 3).
        radii: metres, shape (B,).
    """

    ends: NDArray[np.int64]
    positions: NDArray[np.float32]
    radii: NDArray[np.float32]


def bones_of(joints: NDArray[np.float32]) -> Bones:
    """Return the bones between the labelled joints of a person.

    Args:
        joints: the positions of all joints of JOINT_NAMES, metres, NaN if not labelled, (20, 3).
    """
    labelled = np.flatnonzero(~np.isnan(joints[:, 0]))
    ends = [(labelled[a], labelled[b]) for a, b in default_edges(labelled.tolist())]
    spine = JOINT_NUMBERS['torso'], JOINT_NUMBERS['pelvis']
    if np.isin(spine, labelled).all():
        ends.append(spine)
    ends += [(joint, joint) for joint in labelled if not np.isin(joint, ends)]
    pairs = np.array(ends, np.int64).reshape(-1, 2)
    radii = [_radius(JOINT_NAMES[lower]) for lower in pairs[:, 1]]
    return Bones(pairs, joints[pairs], np.array(radii, np.float32))


def _radius(joint: str) -> float:
    return _RADII.get(joint.rpartition('_')[2], _OTHER_RADIUS)


def parts_at(points: NDArray[np.float32], joints: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the class of each point, shape (n,): 1 + the number of the joint, or NOT_A_PERSON.

    Args:
        points: metres, shape (n, 3).
        joints: as `bones_of`.
    """
    bones = bones_of(joints)
    parts = np.full(len(points), NOT_A_PERSON, np.uint8)
    nearest, fraction = nearest_bones(points, bones, REACH)
    upper_length, lower_length = _lengths_to_ends(bones, nearest, fraction)
    near = (nearest >= 0) & (np.minimum(upper_length, lower_length) <= EXTENT)
    end = (lower_length < upper_length).astype(np.int64)
    parts[near] = 1 + bones.ends[nearest[near], end[near]]
    return parts


def _lengths_to_ends(
    bones: Bones, nearest: NDArray[np.int64], fraction: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the lengths along the nearest bones to their upper and their lower ends, metres."""
    if not len(bones.ends):
        return fraction, fraction
    lengths = np.linalg.norm(bones.positions[:, 1] - bones.positions[:, 0], axis=1)[nearest]
    return fraction * lengths, (1 - fraction) * lengths


@kernel
def nearest_bones(
    points: NDArray[np.float32], bones: Bones, reach: float
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Return the bone with the nearest surface for each point, and where along it.

    The surface of a bone is that of a capsule: all points at a distance of its radius.

    Args:
        points: metres, shape (n, 3).
        bones: the bones.
        reach: the largest distance from a surface, metres.

    Returns:
        The index of the bone, -1 if none is within `reach`, and the fraction of the bone's
        length, from its first end, of its point that is nearest; shape (n,) each. Of bones at
        equal distance, the first.
    """
    nearest = np.full(points.shape[0], -1, np.int64)
    fraction = np.zeros(points.shape[0], np.float32)
    for n in range(points.shape[0]):
        least = np.float32(reach)
        for b in range(bones.ends.shape[0]):
            along = _fraction_along(points[n], bones.positions[b])
            squared = np.float32(0)
            for axis in range(3):
                start, end = bones.positions[b, 0, axis], bones.positions[b, 1, axis]
                difference = points[n, axis] - start - along * (end - start)
                squared += difference * difference
            distance = np.sqrt(squared) - bones.radii[b]
            if distance < least:
                least, nearest[n], fraction[n] = distance, b, along
    return nearest, fraction


@kernel
def _fraction_along(point: NDArray[np.float32], ends: NDArray[np.float32]) -> np.float32:
    """Return the fraction of a bone's length at which it is nearest to a point."""
    dot, squared_length = np.float32(0), np.float32(0)
    for axis in range(3):
        direction = ends[1, axis] - ends[0, axis]
        dot += (point[axis] - ends[0, axis]) * direction
        squared_length += direction * direction
    if squared_length <= 0:
        return np.float32(0)
    return min(max(dot / squared_length, np.float32(0)), np.float32(1))
