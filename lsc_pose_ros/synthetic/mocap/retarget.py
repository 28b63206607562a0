"""Brings motion onto a person: turns of segments to rotations of all bones.

Bones are turned, not brought to places: people's proportions differ.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest, straighten
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, TRUNK
from lsc_pose_ros.synthetic.motion.rotations import about, between, swing

# How far up from one segment of the trunk to the next each bone is: 0.5 is half way between.
_SPINE: dict[str, float] = {
    'root': 0.0, 'spine05': 0.4, 'spine04': 0.8, 'spine03': 1.2, 'spine02': 1.6, 'spine01': 2.0,
    'neck01': 2.5, 'neck02': 3.0, 'neck03': 3.5, 'head': 4.0,
}  # fmt: skip

# How much of the turn about themselves, of upper arm and hand, the bones above take over, so that
# skin is wrung over a length and not in one place.
_SHOULDER_SHARE = 0.5
_FOREARM_SHARES = (0.25, 0.65)

_BLADE_START = 30.0
_BLADE_SHARE = 1 / 3
"""The shoulder blade turns by a third of what the arm rises beyond 30 degrees (Inman, Saunders
and Abbott, Observations on the function of the shoulder joint, 1944)."""

_REACH = 15.0
"""Degrees by which a shoulder comes forward with an arm that points ahead."""


def bone_rotations(
    body: Body, rest: Rest, turns: NDArray[np.float64], *, shoulders: bool = False
) -> NDArray[np.float64]:
    """Return the rotations of all bones against their parents, as `pose_body` takes them.

    Args:
        body: the body.
        rest: the person at rest.
        turns: how segments are turned in space from the straight stance, shape (T, S, 3, 3).
        shoulders: whether those of the shoulders say how they are; else they follow the arms.

    Returns:
        Local rotations, shape (T, B, 3, 3).
    """
    straight = straighten(body, rest)
    segments = {name: turns[:, number] for number, name in enumerate(SEGMENTS)}
    named = _trunk(segments)
    for letter, side in (('l', 1.0), ('r', -1.0)):
        own = {name[2:]: turn for name, turn in segments.items() if name.startswith(f'{letter}_')}
        if not shoulders:
            own['shoulder'] = _shoulder(segments['chest'], own['upper_arm'], side)
        limbs = {**_arm(segments['chest'], own), **_leg(segments['pelvis'], own)}
        named |= {f'{name}.{letter.upper()}': turn for name, turn in limbs.items()}
    return _local(body, straight, named)


def _trunk(segments: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    named = {}
    for bone, position in _SPINE.items():
        below = min(int(position), len(TRUNK) - 2)
        share = position - below
        start, end = segments[TRUNK[below]], segments[TRUNK[below + 1]]
        named[bone] = between(start, end, share)
    return named


def _arm(
    chest: NDArray[np.float64], own: dict[str, NDArray[np.float64]]
) -> dict[str, NDArray[np.float64]]:
    upper, forearm, hand = own['upper_arm'], own['forearm'], own['hand']
    swung = swing(-chest[..., 1], -upper[..., 1]) @ chest
    # Without what the wrist bends.
    wrung = swing(-hand[..., 1], -forearm[..., 1]) @ hand
    return {
        'clavicle': between(chest, own['shoulder'], 0.5),
        'shoulder01': own['shoulder'],
        'upperarm01': between(swung, upper, _SHOULDER_SHARE),
        'upperarm02': upper,
        'lowerarm01': between(forearm, wrung, _FOREARM_SHARES[0]),
        'lowerarm02': between(forearm, wrung, _FOREARM_SHARES[1]),
        'wrist': hand,
    }


def _leg(
    pelvis: NDArray[np.float64], own: dict[str, NDArray[np.float64]]
) -> dict[str, NDArray[np.float64]]:
    return {
        'pelvis': pelvis,
        'upperleg01': own['thigh'],
        'upperleg02': own['thigh'],
        'lowerleg01': own['shank'],
        'lowerleg02': own['shank'],
        'foot': own['foot'],
    }


def _shoulder(
    chest: NDArray[np.float64], upper: NDArray[np.float64], side: float
) -> NDArray[np.float64]:
    """Return the turns of a shoulder that follows its arm: it rises, and comes forward."""
    arm = np.einsum('tji,tj->ti', chest, -upper[..., 1])
    elevation = np.arccos(np.clip(-arm[:, 1], -1.0, 1.0))
    rise = _BLADE_SHARE * np.maximum(0.0, elevation - np.radians(_BLADE_START))
    forward = np.radians(_REACH) * arm[:, 2]
    return chest @ about(2, side * rise) @ about(1, -side * forward)


def _local(
    body: Body, straight: NDArray[np.float64], named: dict[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return local rotations; bones that are not named keep to their parents as if straight."""
    rotations = np.empty((len(named['root']), len(body.bones), 3, 3))
    turns = np.empty_like(rotations)
    for bone, parent in enumerate(body.parents):
        turn = named.get(str(body.bones[bone]))
        if parent < 0:
            turns[:, bone] = rotations[:, bone] = named['root'] @ straight[bone]
            continue
        if turn is None:
            rotations[:, bone] = straight[parent].T @ straight[bone]
            turns[:, bone] = turns[:, parent] @ rotations[:, bone]
        else:
            turns[:, bone] = turn @ straight[bone]
            rotations[:, bone] = turns[:, parent].transpose(0, 2, 1) @ turns[:, bone]
    return rotations
