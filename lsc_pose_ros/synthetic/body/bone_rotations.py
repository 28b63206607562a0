"""From the clinical angles of a pose to the turns of a body's bones.

Several bones share a joint's angle where flesh does: the back bends along the spine, the
forearm's far end turns with the hand, the shoulder rises with the arm.
"""

import re
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest, straighten
from lsc_pose_ros.synthetic.motion.joint_angles import ARM_ANGLES, LEG_ANGLES, TRUNK_ANGLES

# What turns as one: nine parts of trunk and neck, the head, then 16 parts of each side.
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

# How much of the back's and the neck's angles each bone takes, from below; the loins bend most,
# the ribs' part of the spine twists most (White and Panjabi, Clinical Biomechanics of the Spine).
_BEND_SHARES = np.array([0.16, 0.27, 0.25, 0.2, 0.12])
_TWIST_SHARES = np.array([0.05, 0.1, 0.2, 0.35, 0.3])
_NECK_SHARES = np.array([0.2, 0.2, 0.25, 0.35])

_ARM = len(ARM_ANGLES)
_LIMB = len(ARM_ANGLES) + len(LEG_ANGLES)
_TRUNK = len(TRUNK_ANGLES)


class Rig(NamedTuple):
    """How one person's bones hang together, and what turns them.

    Attributes:
        numbers: of the bones, by name.
        parents: each bone's, -1 for the root, shape (B,).
        heads: of the bones at rest, metres, shape (B, 3).
        straight: the bones' turns in a person who stands straight, shape (B, 3, 3).
        parts: which part of the body turns each bone, shape (B,).
        shoulder: heads of clavicle, shoulder blade and upper arm of the left, from that of the
            chest's bone, metres, shape (3, 3).
        arm: lengths of the upper arm, and of the forearm to the middle of the hand, metres, (2,).
        hip: the head of the left thigh, from the pelvis, metres, shape (3,).
        leg: lengths of thigh and shank, how high the ankle is, how far in front of it the ball
            of the foot, metres, shape (4,).
    """

    numbers: dict[str, int]
    parents: NDArray[np.int64]
    heads: NDArray[np.float64]
    straight: NDArray[np.float64]
    parts: NDArray[np.int64]
    shoulder: NDArray[np.float64]
    arm: NDArray[np.float64]
    hip: NDArray[np.float64]
    leg: NDArray[np.float64]


def rig_of(body: Body, rest: Rest) -> Rig:
    """Return what turns the bones of one person."""
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
        straight=np.ascontiguousarray(straighten(body, rest)),
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
    """Return the number of the part of the body that turns the bone called `bone`."""
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


def articulate(rig: Rig, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return bones' rotations against their parents in N poses, as `pose_body` takes them.

    Args:
        rig: the person's.
        angles: in the order of ANGLES, radians, shape (N, A).

    Returns:
        The rotations, shape (N, B, 3, 3); the root's has no yaw.
    """
    return local_turns(np.atleast_2d(angles), rig.straight, rig.parts, rig.parents)


@kernel
def local_turns(
    angles: NDArray[np.float64],
    straight: NDArray[np.float64],
    parts: NDArray[np.int64],
    parents: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Return bones' rotations against their parents in N poses, shape (N, B, 3, 3)."""
    local = np.empty((len(angles), len(parents), 3, 3))
    for pose in range(len(angles)):
        turns = bone_turns(angles[pose], straight, parts)
        local[pose, 0] = turns[0]
        for bone in range(1, len(parents)):
            multiply_back(turns[parents[bone]], turns[bone], local[pose, bone])
    return local


@kernel
def bone_turns(
    angles: NDArray[np.float64], straight: NDArray[np.float64], parts: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return how bones are turned in space in a pose, shape (A,), from rest: (B, 3, 3)."""
    frames = part_turns(angles)
    turns = np.empty_like(straight)
    for bone in range(len(straight)):
        multiply(frames[parts[bone]], straight[bone], turns[bone])
    return turns


@kernel
def bone_heads(
    turns: NDArray[np.float64], parents: NDArray[np.int64], rest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return where bones' heads are, shape (B, 3), metres, from that of the root."""
    heads = np.zeros_like(rest)
    for bone in range(1, len(parents)):
        parent = parents[bone]
        turn = turns[parent]
        x = rest[bone, 0] - rest[parent, 0]
        y = rest[bone, 1] - rest[parent, 1]
        z = rest[bone, 2] - rest[parent, 2]
        for row in range(3):
            along = turn[row, 0] * x + turn[row, 1] * y + turn[row, 2] * z
            heads[bone, row] = heads[parent, row] + along
    return heads


@kernel
def part_turns(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how the body's parts are turned in space in a pose, from standing straight."""
    frames = np.empty((_PARTS, 3, 3))
    local = np.empty((len(_SIDE_PARTS), 3, 3))
    _turn_trunk(angles, frames)
    for side in range(2):
        first = _TRUNK + side * _LIMB
        _turn_arm(angles[first : first + _ARM], local)
        _turn_leg(angles[first + _ARM : first + _LIMB], local)
        for part in range(len(_SIDE_PARTS)):
            if side == 1:
                _reflect(local[part])
            base = _CHEST if part < _FIRST_LEG_PART else 0
            multiply(frames[base], local[part], frames[_LEFT + side * len(_SIDE_PARTS) + part])
    return frames


@kernel
def _reflect(turn: NDArray[np.float64]) -> None:
    """Reflect a rotation in the plane x = 0, in place: these signs turn."""
    for one, other in ((0, 1), (0, 2), (1, 0), (2, 0)):
        turn[one, other] *= -1


_LEAN, _LIST, _BEND, _SIDE, _TWIST, _NOD, _TILT, _TURN = range(_TRUNK)


@kernel
def _turn_trunk(angles: NDArray[np.float64], frames: NDArray[np.float64]) -> None:
    multiply(about_z(-angles[_LIST]), about_x(angles[_LEAN]), frames[0])
    for part in range(1, len(_TRUNK_PARTS)):
        if part <= _CHEST:
            bend, twist = _BEND_SHARES[part - 1], _TWIST_SHARES[part - 1]
            y, x, z = twist * angles[_TWIST], bend * angles[_BEND], bend * angles[_SIDE]
        else:
            share = _NECK_SHARES[part - _CHEST - 1]
            y, x, z = share * angles[_TURN], share * angles[_NOD], share * angles[_TILT]
        turn = product(product(about_y(y), about_x(x)), about_z(-z))
        multiply(frames[part - 1], turn, frames[part])


@kernel
def _turn_arm(arm: NDArray[np.float64], local: NDArray[np.float64]) -> None:
    """Fill in the turns of the left arm's parts from the chest's."""
    plane, elevation, axial, elbow, pronation = arm[0], arm[1], arm[2], arm[3], arm[4]
    flexion, deviation, shrug, fingers = arm[5], arm[6], arm[7], arm[8]
    turn_shoulder(plane, elevation, shrug, local[0], local[1])
    swing = swing_arm(plane, elevation)
    # Skin and muscle at the shoulder turn about the arm's axis only by half.
    multiply(swing, about_y(0.5 * axial), local[2])
    multiply(swing, about_y(axial), local[3])
    forearm = product(local[3], about_x(-elbow))
    multiply(forearm, about_y(-0.15 * pronation), local[4])
    multiply(forearm, about_y(-0.6 * pronation), local[5])
    wrist = product(about_z(-flexion), about_x(-deviation))
    multiply(product(forearm, about_y(-pronation)), wrist, local[6])
    # A fist bends 90 degrees at the knuckles, 100 and 60 beyond; at rest they are bent a little.
    multiply(local[6], about_z(-0.8 * fingers), local[7])
    multiply(local[6], about_z(-1.8 * fingers), local[8])
    multiply(local[6], about_z(-2.4 * fingers), local[9])
    thumb = product(about_y(-0.5 * fingers), about_x(-0.2 * fingers))
    multiply(local[6], thumb, local[10])


@kernel
def _turn_leg(leg: NDArray[np.float64], local: NDArray[np.float64]) -> None:
    """Fill in the turns of the left leg's parts from the pelvis's."""
    flexion, abduction, rotation, knee = leg[0], leg[1], leg[2], leg[3]
    ankle, eversion, toes = leg[4], leg[5], leg[6]
    hip = product(about_x(-flexion), about_z(abduction))
    multiply(hip, about_y(0.5 * rotation), local[11])
    multiply(hip, about_y(rotation), local[12])
    multiply(local[12], about_x(knee), local[13])
    multiply(local[13], product(about_x(ankle), about_z(eversion)), local[14])
    multiply(local[14], about_x(-toes), local[15])


@kernel
def swing_arm(plane: float, elevation: float) -> NDArray[np.float64]:
    """Return the turn of an arm that rises in a plane without turning about itself, (3, 3)."""
    return product(product(about_y(-plane), about_z(elevation)), about_y(plane))


_RESTING = np.radians(5.0)  # at rest the arms are held up by 45 degrees
_FORWARDS = np.radians(14.0)


@kernel
def turn_shoulder(
    plane: float,
    elevation: float,
    shrug: float,
    clavicle: NDArray[np.float64],
    blade: NDArray[np.float64],
) -> None:
    """Fill in the turns of the left clavicle and shoulder blade from the chest's, each (3, 3).

    The shoulder blade rises with the arm: about a third of what the arm rises beyond 30 degrees
    (Inman, Saunders, Abbott, 1944), the clavicle about half of that. Both go forwards with an arm
    that reaches forwards.
    """
    rise = max(0.0, elevation - np.radians(30)) / 3 - _RESTING
    forwards = about_y(-_FORWARDS * np.sin(elevation) * np.sin(plane))
    multiply(forwards, about_z(0.5 * rise + shrug), clavicle)
    multiply(forwards, about_z(rise + shrug), blade)


@kernel
def multiply(
    first: NDArray[np.float64], second: NDArray[np.float64], result: NDArray[np.float64]
) -> None:
    """Fill in the product of two matrices, all of shape (3, 3)."""
    for row in range(3):
        for column in range(3):
            result[row, column] = (
                first[row, 0] * second[0, column]
                + first[row, 1] * second[1, column]
                + first[row, 2] * second[2, column]
            )


@kernel
def multiply_back(
    first: NDArray[np.float64], second: NDArray[np.float64], result: NDArray[np.float64]
) -> None:
    """Fill in the product of the transpose of `first` and `second`, all of shape (3, 3)."""
    for row in range(3):
        for column in range(3):
            result[row, column] = (
                first[0, row] * second[0, column]
                + first[1, row] * second[1, column]
                + first[2, row] * second[2, column]
            )


@kernel
def product(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the product of two matrices, shape (3, 3)."""
    result = np.empty((3, 3))
    multiply(first, second, result)
    return result


@kernel
def turned(turn: NDArray[np.float64], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a vector, shape (3,), turned by a matrix, shape (3, 3)."""
    result = np.empty(3)
    for row in range(3):
        result[row] = (
            turn[row, 0] * vector[0] + turn[row, 1] * vector[1] + turn[row, 2] * vector[2]
        )
    return result


@kernel
def turned_back(turn: NDArray[np.float64], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a vector, shape (3,), turned by the transpose of a matrix, shape (3, 3)."""
    result = np.empty(3)
    for row in range(3):
        result[row] = (
            turn[0, row] * vector[0] + turn[1, row] * vector[1] + turn[2, row] * vector[2]
        )
    return result


@kernel
def about_x(angle: float) -> NDArray[np.float64]:
    """Return the rotation that turns y towards z, shape (3, 3)."""
    return _about(angle, 1, 2)


@kernel
def about_y(angle: float) -> NDArray[np.float64]:
    """Return the rotation that turns z towards x, shape (3, 3)."""
    return _about(angle, 2, 0)


@kernel
def about_z(angle: float) -> NDArray[np.float64]:
    """Return the rotation that turns x towards y, shape (3, 3)."""
    return _about(angle, 0, 1)


@kernel
def _about(angle: float, first: int, second: int) -> NDArray[np.float64]:
    rotation = np.zeros((3, 3))
    axis = 3 - first - second
    rotation[axis, axis] = 1.0
    rotation[first, first] = rotation[second, second] = np.cos(angle)
    rotation[second, first] = np.sin(angle)
    rotation[first, second] = -np.sin(angle)
    return rotation
