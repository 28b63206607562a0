"""A person's pose: joint angles within what joints allow, and where they bring the body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data.synthetic.body import PARENT_SEGMENTS, SEGMENTS, Body

TRUNK_ANGLES: tuple[str, ...] = ('lean', 'bend', 'side', 'twist', 'nod', 'tilt', 'turn')
ARM_ANGLES: tuple[str, ...] = (
    'plane', 'elevation', 'axial', 'elbow', 'pronation', 'wrist_flexion', 'wrist_deviation',
)  # fmt: skip
LEG_ANGLES: tuple[str, ...] = ('hip_flexion', 'hip_abduction', 'hip_rotation', 'knee', 'ankle')

ANGLES: tuple[str, ...] = TRUNK_ANGLES + tuple(
    f'{side}_{name}' for side in ('l', 'r') for name in ARM_ANGLES + LEG_ANGLES
)
ANGLE_NUMBERS: dict[str, int] = {name: number for number, name in enumerate(ANGLES)}

# Degrees. What joints allow is after the American Academy of Orthopaedic Surgeons, Joint Motion:
# Method of Measuring and Recording (1965): thoracolumbar spine 80 flexion, 25 extension, 35
# lateral, 45 rotation; neck 45, 45, 60; shoulder 180 elevation, 60 extension, rotation 70 inwards
# and 90 outwards; elbow 150; forearm 80 each way; wrist 80 flexion, 70 extension, 20 radial, 30
# ulnar; hip 120 flexion, 30 extension, 45 abduction, 30 adduction, rotation 45; knee 135; ankle
# 20 dorsal, 50 plantar. `lean` tips the whole person; how far is ours. Where two people of a
# crowd would still stand on their feet, a narrower range is taken.
LIMITS: dict[str, tuple[float, float]] = {
    'lean': (-8, 40),
    'bend': (-20, 70),
    'side': (-30, 30),
    'twist': (-40, 40),
    'nod': (-40, 40),
    'tilt': (-30, 30),
    'turn': (-60, 60),
    'plane': (-50, 125),  # in which the arm rises: 0 sideways, 90 forwards
    'elevation': (0, 170),
    'axial': (-70, 90),  # of the upper arm, outwards
    'elbow': (0, 145),
    'pronation': (-80, 80),
    'wrist_flexion': (-60, 70),
    'wrist_deviation': (-30, 20),
    'hip_flexion': (-25, 115),
    'hip_abduction': (-12, 45),
    'hip_rotation': (-30, 40),
    'knee': (0, 130),
    'ankle': (-20, 45),  # plantar
}

_BEHIND = 60.0  # how far the arm rises straight backwards, degrees
_ACROSS = 110.0  # and across the chest


class Placement(NamedTuple):
    """Where the segments of N poses are.

    Attributes:
        origins: metres, shape (N, 16, 3).
        rotations: from the segment's frame, shape (N, 16, 3, 3).
    """

    origins: NDArray[np.float64]
    rotations: NDArray[np.float64]


def limits() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest value of every angle of ANGLES, radians, each (A,)."""
    pairs = [LIMITS[name if name in TRUNK_ANGLES else name.partition('_')[2]] for name in ANGLES]
    low, high = np.radians(np.array(pairs, dtype=np.float64)).T
    return low, high


def within_limits(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `angles`, radians, shape (..., A), brought within what joints allow.

    How far the arm rises depends on where it rises: less behind the back and across the chest
    than sideways and forwards.
    """
    low, high = limits()
    kept: NDArray[np.float64] = np.clip(angles, low, high)
    sideways = high[ANGLE_NUMBERS['l_elevation']]
    for side in ('l', 'r'):
        plane = kept[..., ANGLE_NUMBERS[f'{side}_plane']]
        most = np.interp(
            plane,
            np.radians([-90, 0, 90, 130]),
            [np.radians(_BEHIND), sideways, sideways, np.radians(_ACROSS)],
        )
        column = ANGLE_NUMBERS[f'{side}_elevation']
        kept[..., column] = np.minimum(kept[..., column], most)
    return kept


def place_segments(body: Body, angles: NDArray[np.float64]) -> Placement:
    """Return where the segments are in N poses: forward kinematics.

    Args:
        body: the person.
        angles: radians, shape (N, A).

    Returns:
        The segments in the person's frame: x left, y up, z forward, mid-hip at the origin.
    """
    count = len(angles)
    turns = _segment_turns(angles)
    shifts = _shoulder_shifts(body, angles)
    origins = np.zeros((count, len(SEGMENTS), 3))
    rotations = np.empty((count, len(SEGMENTS), 3, 3))
    rotations[:, 0] = turns[0]
    for segment, parent in enumerate(PARENT_SEGMENTS):
        if parent < 0:
            continue
        offset = body.pivots[segment] + shifts.get(segment, 0.0)
        turned = np.einsum('nij,nj->ni', rotations[:, parent], np.broadcast_to(offset, (count, 3)))
        origins[:, segment] = origins[:, parent] + turned
        rotations[:, segment] = rotations[:, parent] @ turns[segment]
    return Placement(origins, rotations)


def joint_positions(body: Body, placement: Placement) -> NDArray[np.float64]:
    """Return the joints of the vocabulary in the frame of `placement`, metres, (N, 20, 3)."""
    carriers = body.joint_segments
    positions: NDArray[np.float64] = placement.origins[:, carriers] + np.einsum(
        'njkl,jl->njk', placement.rotations[:, carriers], body.joint_offsets
    )
    return positions


def sole_height(body: Body, placement: Placement) -> NDArray[np.float64]:
    """Return the height of the lowest point of either sole, shape (N,), metres."""
    foot = body.joint_offsets[body.joint_segments == SEGMENTS.index('l_foot')]
    length = float(foot[:, 2].max()) * 2
    heights = []
    for name in ('l_foot', 'r_foot'):
        segment = SEGMENTS.index(name)
        for forward in (-0.25 * length, 0.72 * length):
            point = np.array([0.0, -body.ankle_height, forward])
            height = placement.origins[:, segment, 1]
            heights.append(height + placement.rotations[:, segment, 1] @ point)
    lowest: NDArray[np.float64] = np.min(heights, axis=0)
    return lowest


def _segment_turns(angles: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Return each segment's rotation in its parent's frame, a list of (N, 3, 3)."""
    named = {name: angles[:, number] for name, number in ANGLE_NUMBERS.items()}
    half = 0.5  # the back bends in two places
    back = (
        _about_y(half * named['twist'])
        @ _about_x(half * named['bend'])
        @ _about_z(-half * named['side'])
    )
    head = _about_y(named['turn']) @ _about_x(named['nod']) @ _about_z(-named['tilt'])
    turns = [_about_x(named['lean']), back, back, head]
    for side in ('l', 'r'):
        limbs = _limb_turns({name: named[f'{side}_{name}'] for name in ARM_ANGLES + LEG_ANGLES})
        turns += limbs if side == 'l' else [_MIRROR * turn for turn in limbs]
    return turns


# Reflecting a rotation in the plane x = 0 turns these signs.
_MIRROR = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])


def _limb_turns(named: dict[str, NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Return the rotations of the left arm's and leg's six segments in their parents' frames."""
    # The arm swings up in a plane without turning about itself, then turns about itself.
    swing = _about_y(-named['plane']) @ _about_z(named['elevation']) @ _about_y(named['plane'])
    return [
        swing @ _about_y(named['axial']),
        _about_x(-named['elbow']),
        _about_y(-named['pronation'])
        @ _about_z(-named['wrist_flexion'])
        @ _about_x(-named['wrist_deviation']),
        _about_x(-named['hip_flexion'])
        @ _about_z(named['hip_abduction'])
        @ _about_y(named['hip_rotation']),
        _about_x(named['knee']),
        _about_x(named['ankle']),
    ]


def _shoulder_shifts(body: Body, angles: NDArray[np.float64]) -> dict[int, NDArray[np.float64]]:
    """Return how far the shoulder joints move as the arms rise, for each upper arm (N, 3).

    The shoulder blade turns with the arm: about a third of what it rises beyond 30 degrees
    (Inman, Saunders, Abbott, 1944), which lifts the joint and brings it inwards.
    """
    shifts = {}
    for name, sign in (('l', 1.0), ('r', -1.0)):
        elevation = angles[:, ANGLE_NUMBERS[f'{name}_elevation']]
        turn = np.maximum(0.0, elevation - np.radians(30)) / 3
        radius = abs(float(body.pivots[SEGMENTS.index(f'{name}_upper_arm'), 0])) * 0.6
        inwards = sign * radius * (np.cos(turn) - 1)
        shifts[SEGMENTS.index(f'{name}_upper_arm')] = np.stack(
            [inwards, radius * np.sin(turn), np.zeros_like(turn)], axis=1
        )
    return shifts


def _about_x(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return _about(angle, 1, 2)


def _about_y(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return _about(angle, 2, 0)


def _about_z(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return _about(angle, 0, 1)


def _about(angle: NDArray[np.float64], first: int, second: int) -> NDArray[np.float64]:
    """Return the rotations, shape (N, 3, 3), that turn axis `first` towards axis `second`."""
    rotation = np.zeros((*angle.shape, 3, 3))
    axis = 3 - first - second
    rotation[..., axis, axis] = 1.0
    rotation[..., first, first] = rotation[..., second, second] = np.cos(angle)
    rotation[..., second, first] = np.sin(angle)
    rotation[..., first, second] = -np.sin(angle)
    return rotation
