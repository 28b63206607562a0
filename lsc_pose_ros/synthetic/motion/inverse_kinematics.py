"""Inverse kinematics of arms and legs: the angles that bring a hand or a foot to a place.

An arm or a leg is two bones, so the law of cosines tells how far elbow or knee are bent; the
elbow is free to go round the line from shoulder to hand, the knee points where it should.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    about_x,
    about_y,
    about_z,
    product,
    swing_arm,
    turn_shoulder,
    turned,
    turned_back,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ARM_ANGLES,
    ARMS,
    HIGHEST,
    LEGS,
    LOWEST,
    highest_elevation,
)

REACHED = 0.02
"""A hand that comes so near to its place has reached it, metres."""

_ARM_LIMITS = np.stack([LOWEST[ARMS[0]], HIGHEST[ARMS[0]]])
_LEG_LIMITS = np.stack([LOWEST[LEGS[0]], HIGHEST[LEGS[0]]])
_PLANE, _ELEVATION, _AXIAL, _ELBOW, _PRONATION = range(5)
_FLEX = ARM_ANGLES.index('wrist_flexion')
_SHRUG = ARM_ANGLES.index('shrug')
_FLEXION, _ABDUCTION, _ROTATION, _KNEE, _ANKLE, _EVERSION, _TOES = range(7)

_TINY = 1e-6  # metres

_SWIVELS = 13  # ways to hold the elbow that are tried
_SETTLING = 4  # the shoulder goes with the arm: so often it is placed anew


class Foot(NamedTuple):
    """Where and how a foot is put down, in the person's axes.

    Attributes:
        ankle: the place, metres from the pelvis, shape (3,).
        heading: where knee and toes point, radians, 0 forwards, positive to the outside.
        pitch: how far the heel is lifted, radians.
    """

    ankle: NDArray[np.float64]
    heading: float
    pitch: float


def reach(
    rig: Rig, arm: NDArray[np.float64], place: NDArray[np.float64], swivel: float
) -> tuple[NDArray[np.float64], float]:
    """Bring a hand's middle to a place, the elbow as near to where it is wanted as joints allow.

    Args:
        rig: the person's.
        arm: the left arm's angles; of those that matter not, nothing is changed; radians.
        place: metres from the head of the chest's bone, in its axes, shape (3,); for the right
            arm, its mirror image.
        swivel: how far the elbow is to be raised outwards from hanging down, radians.

    Returns:
        The arm's angles within limits, and how far the hand is from the place, metres.
    """
    return reach_place(arm, place, swivel, rig.shoulder, rig.arm)


@kernel
def reach_place(
    arm: NDArray[np.float64],
    place: NDArray[np.float64],
    swivel: float,
    shoulder: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """Try swivels, the wanted one first, until the hand reaches its place."""
    best, least = arm.copy(), np.inf
    for step in range(_SWIVELS):
        off = (step + 1) // 2 * (1 if step % 2 else -1)
        tried = arm.copy()
        for _ in range(_SETTLING):
            solve_arm(tried, place, swivel + off * 2 * np.pi / _SWIVELS, shoulder, lengths)
        miss = _length(_blend(1.0, hand_place(tried, shoulder, lengths), -1.0, place))
        if miss < least - 1e-6:
            best, least = tried, miss
        if least < REACHED:
            break
    return best, least


@kernel
def shoulder_place(arm: NDArray[np.float64], shoulder: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the left shoulder joint is, from the chest's bone and in its axes, (3,)."""
    clavicle, blade = np.empty((3, 3)), np.empty((3, 3))
    turn_shoulder(arm[_PLANE], arm[_ELEVATION], arm[_SHRUG], clavicle, blade)
    inner = turned(clavicle, _blend(1.0, shoulder[1], -1.0, shoulder[0]))
    outer = turned(blade, _blend(1.0, shoulder[2], -1.0, shoulder[1]))
    return _blend(1.0, shoulder[0], 1.0, _blend(1.0, inner, 1.0, outer))


@kernel
def forearm_turn(arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how the left forearm is turned from the chest, before pronation, (3, 3)."""
    upper = product(swing_arm(arm[_PLANE], arm[_ELEVATION]), about_y(arm[_AXIAL]))
    return product(upper, about_x(-arm[_ELBOW]))


@kernel
def hand_place(
    arm: NDArray[np.float64], shoulder: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return where the middle of the left hand is if the wrist is straight, shape (3,)."""
    upper = swing_arm(arm[_PLANE], arm[_ELEVATION])[:, 1]
    along = _blend(-lengths[0], upper, -lengths[1], forearm_turn(arm)[:, 1])
    return _blend(1.0, shoulder_place(arm, shoulder), 1.0, along)


@kernel
def solve_arm(
    arm: NDArray[np.float64],
    place: NDArray[np.float64],
    swivel: float,
    shoulder: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> None:
    """Set the left arm's angles, in place, as if the shoulder stayed where it is.

    With a and b the lengths and d the distance, the elbow is off the line to the hand by the
    angle alpha with cos alpha = (a^2 + d^2 - b^2) / (2 a d), and is bent by the angle of which
    the cosine is (d^2 - a^2 - b^2) / (2 a b).
    """
    a, b = lengths[0], lengths[1]
    way = _blend(1.0, place, -1.0, shoulder_place(arm, shoulder))
    length = _length(way)
    if length < _TINY:
        return
    u = _blend(1 / length, way, 0.0, way)
    closest = np.sqrt(a * a + b * b + 2 * a * b * np.cos(_ARM_LIMITS[1, _ELBOW]))
    d = min(max(length, closest), 0.9995 * (a + b))
    # Where the elbow hangs, or where it is behind a hand that hangs.
    down = _across(np.array([0.0, -1.0, -0.25]), u)
    pole = _blend(np.cos(swivel), down, np.sin(swivel), _cross(u, down))
    cosine = min(max((a * a + d * d - b * b) / (2 * a * d), -1.0), 1.0)
    upper = _blend(cosine, u, np.sqrt(1 - cosine * cosine), pole)
    ahead = _across(_blend(d, u, -a, upper), upper)
    arm[_ELBOW] = np.arccos(min(max((d * d - a * a - b * b) / (2 * a * b), -1.0), 1.0))
    arm[_ELEVATION] = np.arccos(min(max(-upper[1], -1.0), 1.0))
    arm[_PLANE] = np.arctan2(upper[2], upper[0])
    if _length(ahead) > _TINY:
        seen = turned_back(swing_arm(arm[_PLANE], arm[_ELEVATION]), ahead)
        arm[_AXIAL] = np.arctan2(seen[0], seen[2])
    keep_arm(arm)


@kernel
def keep_arm(arm: NDArray[np.float64]) -> None:
    """Bring an arm's angles, in place, within what joints allow."""
    for angle in range(len(arm)):
        arm[angle] = min(max(arm[angle], _ARM_LIMITS[0, angle]), _ARM_LIMITS[1, angle])
    highest = highest_elevation(arm[_PLANE], _ARM_LIMITS[1, _ELEVATION])
    arm[_ELEVATION] = min(arm[_ELEVATION], highest)


@kernel
def face_palm(arm: NDArray[np.float64], wanted: NDArray[np.float64]) -> float:
    """Return the pronation, within limits, that lets the left palm face a direction best.

    Args:
        arm: the left arm's angles.
        wanted: the direction in the chest's axes, shape (3,).
    """
    seen = turned_back(forearm_turn(arm), wanted)
    best = np.arctan2(-seen[2], -seen[0])
    return float(min(max(best, _ARM_LIMITS[0, _PRONATION]), _ARM_LIMITS[1, _PRONATION]))


@kernel
def lay_palm(arm: NDArray[np.float64], inwards: NDArray[np.float64]) -> None:
    """Set the left hand's angles, in place, so that it lies flat on what is in a direction.

    Args:
        arm: the left arm's angles.
        inwards: into what it lies on, in the chest's axes, shape (3,).
    """
    arm[_PRONATION] = face_palm(arm, inwards)
    hand = product(forearm_turn(arm), about_y(-arm[_PRONATION]))
    seen = turned_back(hand, inwards)
    # Flexion brings the fingers, -y, towards the palm, -x; they are to be level on the surface.
    arm[_FLEX] = np.arctan2(seen[1], max(-seen[0], 0.2))
    keep_arm(arm)


def plant(
    rig: Rig, pelvis: NDArray[np.float64], foot: Foot, *, right: bool
) -> NDArray[np.float64]:
    """Return the angles of a leg whose foot is put down, sole level if the heel is not lifted.

    Args:
        rig: the person's.
        pelvis: how it is turned in space, shape (3, 3).
        foot: where; if it is too far away, the leg is stretched towards it.
        right: the foot is the right one.
    """
    if right:
        mirror = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
        pelvis = mirror * pelvis
        foot = foot._replace(ankle=foot.ankle * np.array([-1.0, 1.0, 1.0]))
    return plant_foot(pelvis, foot.ankle, foot.heading, foot.pitch, rig.hip, rig.leg)


@kernel
def plant_foot(
    pelvis: NDArray[np.float64],
    ankle: NDArray[np.float64],
    heading: float,
    pitch: float,
    hip: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the angles of the left leg, shape (7,), whose ankle goes to a place."""
    leg = np.zeros(7)
    a, b = lengths[0], lengths[1]
    way = _blend(1.0, turned_back(pelvis, ankle), -1.0, hip)
    length = max(_length(way), _TINY)
    u = _blend(1 / length, way, 0.0, way)
    d = min(max(length, abs(a - b) + 0.1 * a), 0.9995 * (a + b))
    ahead = turned_back(pelvis, np.array([np.sin(heading), 0.0, np.cos(heading)]))
    pole = _across(ahead, u)
    cosine = min(max((a * a + d * d - b * b) / (2 * a * d), -1.0), 1.0)
    sine = np.sqrt(1 - cosine * cosine)
    up = _blend(-cosine, u, -sine, pole)
    front = _blend(cosine, pole, -sine, u)
    aside = _cross(up, front)
    # The turn of which these are the columns is Rx(-flexion) Rz(abduction) Ry(rotation).
    leg[_ABDUCTION] = np.arcsin(min(max(-up[0], -1.0), 1.0))
    leg[_FLEXION] = np.arctan2(-up[2], up[1])
    leg[_ROTATION] = np.arctan2(front[0], aside[0])
    leg[_KNEE] = np.arccos(min(max((d * d - a * a - b * b) / (2 * a * b), -1.0), 1.0))
    _keep_leg(leg)
    level_foot(leg, pelvis, pitch)
    return leg


@kernel
def level_foot(leg: NDArray[np.float64], pelvis: NDArray[np.float64], pitch: float) -> None:
    """Set the ankle's angles, in place, so that the left sole is level but for a lifted heel."""
    turn = product(about_x(-leg[_FLEXION]), about_z(leg[_ABDUCTION]))
    turn = product(product(turn, about_y(leg[_ROTATION])), about_x(leg[_KNEE]))
    shank = product(pelvis, turn)
    leg[_ANKLE] = np.arctan2(shank[1, 2], shank[1, 1]) + pitch
    _keep_leg(leg)
    foot = product(shank, about_x(leg[_ANKLE]))
    leg[_EVERSION] = np.arctan2(-foot[1, 0], foot[1, 1])
    leg[_TOES] = max(pitch, 0.0)
    _keep_leg(leg)


@kernel
def _keep_leg(leg: NDArray[np.float64]) -> None:
    for angle in range(len(leg)):
        leg[angle] = min(max(leg[angle], _LEG_LIMITS[0, angle]), _LEG_LIMITS[1, angle])


@kernel
def _blend(
    a: float, first: NDArray[np.float64], b: float, second: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a times the first plus b times the second vector, shape (3,)."""
    blend = np.empty(3)
    for axis in range(3):
        blend[axis] = a * first[axis] + b * second[axis]
    return blend


@kernel
def _length(vector: NDArray[np.float64]) -> float:
    return float(np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2))


@kernel
def _cross(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    cross = np.empty(3)
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        cross[axis] = first[one] * second[other] - first[other] * second[one]
    return cross


@kernel
def _across(vector: NDArray[np.float64], unit: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the direction of what of `vector` is across a unit vector; 0 if nothing is."""
    along = vector[0] * unit[0] + vector[1] * unit[1] + vector[2] * unit[2]
    across = _blend(1.0, vector, -along, unit)
    length = max(_length(across), _TINY)
    return _blend(1 / length, across, 0.0, across)
