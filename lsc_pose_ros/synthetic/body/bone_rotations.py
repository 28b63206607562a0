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

"""Bone rotations from the clinical joint angles of a pose.

Several bones share a joint's angle, as in a real body: the back bends along the whole spine, the
distal forearm rotates with the hand, and the shoulder rises with the arm.
"""

import re
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody, standing_orientations
from lsc_pose_ros.synthetic.geometry.rotation_kernels import (
    about_x,
    about_y,
    about_z,
    multiply,
    multiply_transposed,
    product,
)
from lsc_pose_ros.synthetic.motion.joint_angles import ARM_ANGLES, LEG_ANGLES, TRUNK_ANGLES

# The body parts, each of which rotates as a whole: ten of trunk, neck and head, then 16 per side.
_TRUNK_PARTS = (
    'root', 'spine05', 'spine04', 'spine03', 'spine02', 'spine01',
    'neck01', 'neck02', 'neck03', 'head',
)  # fmt: skip
_SIDE_PARTS = (
    'clavicle', 'shoulder01', 'upperarm01', 'upperarm02', 'lowerarm01', 'lowerarm02', 'wrist',
    'finger-1', 'finger-2', 'finger-3', 'thumb',
    'upperleg01', 'upperleg02', 'lowerleg01', 'foot', 'toes',
)  # fmt: skip
_CHEST = _TRUNK_PARTS.index('spine01')
_FIRST_LEG_PART = _SIDE_PARTS.index('upperleg01')
_PARTS = len(_TRUNK_PARTS) + 2 * len(_SIDE_PARTS)
_LEFT, _RIGHT = len(_TRUNK_PARTS), len(_TRUNK_PARTS) + len(_SIDE_PARTS)

# Fraction of the back's and the neck's angles that each bone takes, from below. The lumbar spine
# bends most, the thoracic spine twists most (White and Panjabi, Clinical Biomechanics of the
# Spine).
_BEND_FRACTIONS = np.array([0.16, 0.27, 0.25, 0.2, 0.12])
_TWIST_FRACTIONS = np.array([0.05, 0.1, 0.2, 0.35, 0.3])
_NECK_FRACTIONS = np.array([0.2, 0.2, 0.25, 0.35])

_ARM = len(ARM_ANGLES)
_LIMB = len(ARM_ANGLES) + len(LEG_ANGLES)
_TRUNK = len(TRUNK_ANGLES)


class Rig(NamedTuple):
    """The bones of one person and the body parts that rotate them.

    Attributes:
        numbers: the bones' numbers by name.
        parents: the number of each bone's parent, -1 for the root, shape (B,).
        heads: the bones' heads in the rest pose, metres, shape (B, 3).
        standing: the bones' orientations in the standing pose, shape (B, 3, 3).
        parts: the number of the body part that rotates each bone, shape (B,).
        shoulder: heads of the left clavicle, shoulder blade and upper arm, relative to the chest
            bone's head, metres, shape (3, 3).
        arm: lengths of the upper arm and of the forearm up to the middle of the hand, metres,
            (2,).
        hip: the head of the left thigh relative to the pelvis, metres, shape (3,).
        leg: lengths of thigh and shank, height of the ankle, and distance from the ankle forwards
            to the ball of the foot, metres, shape (4,).
    """

    numbers: dict[str, int]
    parents: NDArray[np.int64]
    heads: NDArray[np.float64]
    standing: NDArray[np.float64]
    parts: NDArray[np.int64]
    shoulder: NDArray[np.float64]
    arm: NDArray[np.float64]
    hip: NDArray[np.float64]
    leg: NDArray[np.float64]


def rig_of(body: BodyModel, rest: RestBody) -> Rig:
    """Return the rig of one person."""
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    at = {name: rest.heads[number] for name, number in numbers.items()}

    def length(first: str, last: str) -> float:
        return float(np.sqrt(((at[last] - at[first]) ** 2).sum()))

    palm = 0.5 * length('wrist.L', 'finger3-1.L')
    sole = float(rest.vertices[:, 1].min())
    return Rig(
        numbers=numbers,
        parents=body.parents.astype(np.int64),
        heads=np.ascontiguousarray(rest.heads, np.float64),
        standing=np.ascontiguousarray(standing_orientations(body, rest)),
        parts=np.array([_part(name) for name in numbers]),
        shoulder=np.array([at[name] for name in ('clavicle.L', 'shoulder01.L', 'upperarm01.L')])
        - at['spine01'],
        arm=np.array(
            [
                length('upperarm01.L', 'lowerarm01.L'),
                length('lowerarm01.L', 'wrist.L') + palm,
            ]
        ),
        hip=at['upperleg01.L'] - at['root'],
        leg=np.array(
            [
                length('upperleg01.L', 'lowerleg01.L'),
                length('lowerleg01.L', 'foot.L'),
                at['foot.L'][1] - sole,
                np.hypot(*(at['toes.L'] - at['foot.L'])[[0, 2]]),
            ]
        ),
    )


@cache
def _part(bone: str) -> int:
    """Return the number of the body part that rotates the bone called `bone`."""
    if bone in _TRUNK_PARTS:
        return _TRUNK_PARTS.index(bone)
    name, side = bone[:-2], bone[-1]
    if name == 'pelvis':
        return 0
    name = name.replace('lowerleg02', 'lowerleg01')
    name = re.sub(r'metacarpal\d', 'wrist', name)
    name = re.sub(r'finger1-\d', 'thumb', name)
    name = re.sub(r'finger\d-', 'finger-', name)
    return (_LEFT if side == 'L' else _RIGHT) + _SIDE_PARTS.index(name)


def pose_rotations(rig: Rig, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the bones' rotations relative to their parents in N poses, for `pose_body`.

    Args:
        rig: the person's rig.
        angles: in the order of ANGLES, radians, shape (N, A).

    Returns:
        The rotations, shape (N, B, 3, 3); the root's rotation includes no yaw.
    """
    return relative_bone_rotations(np.atleast_2d(angles), rig.standing, rig.parts, rig.parents)


@kernel
def relative_bone_rotations(
    angles: NDArray[np.float64],
    standing: NDArray[np.float64],
    parts: NDArray[np.int64],
    parents: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Return the bones' rotations relative to their parents in N poses, shape (N, B, 3, 3)."""
    local = np.empty((len(angles), len(parents), 3, 3))
    for pose in range(len(angles)):
        orientations = bone_orientations(angles[pose], standing, parts)
        local[pose, 0] = orientations[0]
        for bone in range(1, len(parents)):
            multiply_transposed(orientations[parents[bone]], orientations[bone], local[pose, bone])
    return local


@kernel
def bone_orientations(
    angles: NDArray[np.float64], standing: NDArray[np.float64], parts: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the bones' orientations in a pose, shape (A,), from the rest pose: (B, 3, 3)."""
    frames = part_orientations(angles)
    orientations = np.empty_like(standing)
    for bone in range(len(standing)):
        multiply(frames[parts[bone]], standing[bone], orientations[bone])
    return orientations


@kernel
def bone_heads(
    orientations: NDArray[np.float64], parents: NDArray[np.int64], rest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the positions of the bones' heads relative to the root's, metres, shape (B, 3)."""
    heads = np.zeros_like(rest)
    for bone in range(1, len(parents)):
        parent = parents[bone]
        rotation = orientations[parent]
        x = rest[bone, 0] - rest[parent, 0]
        y = rest[bone, 1] - rest[parent, 1]
        z = rest[bone, 2] - rest[parent, 2]
        for row in range(3):
            along = rotation[row, 0] * x + rotation[row, 1] * y + rotation[row, 2] * z
            heads[bone, row] = heads[parent, row] + along
    return heads


@kernel
def part_orientations(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the orientations of the body parts, from the standing pose, shape (42, 3, 3)."""
    frames = np.empty((_PARTS, 3, 3))
    local = np.empty((len(_SIDE_PARTS), 3, 3))
    _set_trunk(angles, frames)
    for side in range(2):
        first = _TRUNK + side * _LIMB
        _set_arm(angles[first : first + _ARM], local)
        _set_leg(angles[first + _ARM : first + _LIMB], local)
        for part in range(len(_SIDE_PARTS)):
            if side == 1:
                _reflect(local[part])
            base = _CHEST if part < _FIRST_LEG_PART else 0
            multiply(frames[base], local[part], frames[_LEFT + side * len(_SIDE_PARTS) + part])
    return frames


@kernel
def _reflect(rotation: NDArray[np.float64]) -> None:
    """Reflect a rotation in the plane x = 0, in place; that changes these signs."""
    for one, other in ((0, 1), (0, 2), (1, 0), (2, 0)):
        rotation[one, other] *= -1


_LEAN, _LIST, _BEND, _SIDE, _TWIST, _NOD, _TILT, _TURN = range(_TRUNK)


@kernel
def _set_trunk(angles: NDArray[np.float64], frames: NDArray[np.float64]) -> None:
    multiply(about_z(-angles[_LIST]), about_x(angles[_LEAN]), frames[0])
    for part in range(1, len(_TRUNK_PARTS)):
        if part <= _CHEST:
            bend, twist = _BEND_FRACTIONS[part - 1], _TWIST_FRACTIONS[part - 1]
            y, x, z = twist * angles[_TWIST], bend * angles[_BEND], bend * angles[_SIDE]
        else:
            fraction = _NECK_FRACTIONS[part - _CHEST - 1]
            y, x, z = fraction * angles[_TURN], fraction * angles[_NOD], fraction * angles[_TILT]
        rotation = product(product(about_y(y), about_x(x)), about_z(-z))
        multiply(frames[part - 1], rotation, frames[part])


@kernel
def _set_arm(arm: NDArray[np.float64], local: NDArray[np.float64]) -> None:
    """Set the rotations of the left arm's parts relative to the chest."""
    plane, elevation, axial, elbow, pronation = arm[0], arm[1], arm[2], arm[3], arm[4]
    flexion, deviation, shrug, fingers = arm[5], arm[6], arm[7], arm[8]
    set_shoulder_rotations(plane, elevation, shrug, local[0], local[1])
    raised = elevation_rotation(plane, elevation)
    # Skin and muscle at the shoulder take only half of the axial rotation.
    multiply(raised, about_y(0.5 * axial), local[2])
    multiply(raised, about_y(axial), local[3])
    forearm = product(local[3], about_x(-elbow))
    multiply(forearm, about_y(-0.15 * pronation), local[4])
    multiply(forearm, about_y(-0.6 * pronation), local[5])
    wrist = product(about_z(-flexion), about_x(-deviation))
    multiply(product(forearm, about_y(-pronation)), wrist, local[6])
    # In a fist, the finger joints bend by 90, 100 and 60 degrees; they are slightly bent at rest.
    multiply(local[6], about_z(-0.8 * fingers), local[7])
    multiply(local[6], about_z(-1.8 * fingers), local[8])
    multiply(local[6], about_z(-2.4 * fingers), local[9])
    thumb = product(about_y(-0.5 * fingers), about_x(-0.2 * fingers))
    multiply(local[6], thumb, local[10])


@kernel
def _set_leg(leg: NDArray[np.float64], local: NDArray[np.float64]) -> None:
    """Set the rotations of the left leg's parts relative to the pelvis."""
    flexion, abduction, rotation, knee = leg[0], leg[1], leg[2], leg[3]
    ankle, eversion, toes = leg[4], leg[5], leg[6]
    hip = product(about_x(-flexion), about_z(abduction))
    multiply(hip, about_y(0.5 * rotation), local[11])
    multiply(hip, about_y(rotation), local[12])
    multiply(local[12], about_x(knee), local[13])
    multiply(local[13], product(about_x(ankle), about_z(eversion)), local[14])
    multiply(local[14], about_x(-toes), local[15])


@kernel
def elevation_rotation(plane: float, elevation: float) -> NDArray[np.float64]:
    """Return the rotation of an arm that is raised in a plane without axial rotation, (3, 3)."""
    return product(product(about_y(-plane), about_z(elevation)), about_y(plane))


_RESTING = np.radians(5.0)  # in the rest pose the arms are raised by 45 degrees
_FORWARDS = np.radians(14.0)


@kernel
def set_shoulder_rotations(
    plane: float,
    elevation: float,
    shrug: float,
    clavicle: NDArray[np.float64],
    blade: NDArray[np.float64],
) -> None:
    """Set the rotations of left clavicle and shoulder blade relative to the chest, (3, 3) each.

    The shoulder blade rises by about a third of the arm's elevation beyond 30 degrees (Inman,
    Saunders, Abbott, 1944), and the clavicle by about half of that. Both move forwards with an arm
    that points forwards.
    """
    rise = max(0.0, elevation - np.radians(30)) / 3 - _RESTING
    forwards = about_y(-_FORWARDS * np.sin(elevation) * np.sin(plane))
    multiply(forwards, about_z(0.5 * rise + shrug), clavicle)
    multiply(forwards, about_z(rise + shrug), blade)
