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

"""Retargets motion to a person: from the orientations of segments to the rotations of all bones.

Only rotations are transferred, not positions, because people's proportions differ.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody, standing_orientations
from lsc_pose_ros.synthetic.geometry.rotations import (
    axis_rotation,
    interpolate_rotations,
    shortest_rotation,
)
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, TRUNK

# Position of each bone between the segments of the trunk: 0.5 is half way between two.
_SPINE: dict[str, float] = {
    'root': 0.0, 'spine05': 0.4, 'spine04': 0.8, 'spine03': 1.2, 'spine02': 1.6, 'spine01': 2.0,
    'neck01': 2.5, 'neck02': 3.0, 'neck03': 3.5, 'head': 4.0,
}  # fmt: skip

# Fraction of the axial rotation of upper arm and hand that the bones above them take over, so that
# the skin is twisted along the whole limb.
_SHOULDER_FRACTION = 0.5
_FOREARM_FRACTIONS = (0.25, 0.65)

_BLADE_START = 30.0
_BLADE_FRACTION = 1 / 3
"""The shoulder blade rotates by a third of the arm's elevation beyond 30 degrees (Inman, Saunders
and Abbott, Observations on the function of the shoulder joint, 1944).
"""

_FORWARD_SHOULDER = 15.0
"""Angle by which a shoulder moves forward with an arm that points ahead, degrees."""


def retarget_motion(
    body: BodyModel, rest: RestBody, orientations: NDArray[np.float64], *, shoulders: bool = False
) -> NDArray[np.float64]:
    """Return the rotations of all bones relative to their parents, for `pose_body`.

    Args:
        body: the body model.
        rest: the person in the rest pose.
        orientations: of the segments relative to the standing pose, shape (T, S, 3, 3).
        shoulders: whether those of the shoulders were captured; otherwise, they follow the arms.

    Returns:
        Rotations, shape (T, B, 3, 3).
    """
    standing = standing_orientations(body, rest)
    segments = {name: orientations[:, number] for number, name in enumerate(SEGMENTS)}
    named = _trunk(segments)
    for letter, side in (('l', 1.0), ('r', -1.0)):
        own = {
            name[2:]: orientation
            for name, orientation in segments.items()
            if name.startswith(f'{letter}_')
        }
        if not shoulders:
            own['shoulder'] = _shoulder(segments['chest'], own['upper_arm'], side)
        limbs = {**_arm(segments['chest'], own), **_leg(segments['pelvis'], own)}
        named |= {f'{name}.{letter.upper()}': orientation for name, orientation in limbs.items()}
    return _local(body, standing, named)


def _trunk(segments: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    named = {}
    for bone, position in _SPINE.items():
        below = min(int(position), len(TRUNK) - 2)
        fraction = position - below
        start, end = segments[TRUNK[below]], segments[TRUNK[below + 1]]
        named[bone] = interpolate_rotations(start, end, fraction)
    return named


def _arm(
    chest: NDArray[np.float64], own: dict[str, NDArray[np.float64]]
) -> dict[str, NDArray[np.float64]]:
    upper, forearm, hand = own['upper_arm'], own['forearm'], own['hand']
    raised = shortest_rotation(-chest[..., 1], -upper[..., 1]) @ chest
    # Without the flexion of the wrist.
    twisted = shortest_rotation(-hand[..., 1], -forearm[..., 1]) @ hand
    return {
        'clavicle': interpolate_rotations(chest, own['shoulder'], 0.5),
        'shoulder01': own['shoulder'],
        'upperarm01': interpolate_rotations(raised, upper, _SHOULDER_FRACTION),
        'upperarm02': upper,
        'lowerarm01': interpolate_rotations(forearm, twisted, _FOREARM_FRACTIONS[0]),
        'lowerarm02': interpolate_rotations(forearm, twisted, _FOREARM_FRACTIONS[1]),
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
    """Return the orientations of a shoulder that rises and moves forward with its arm."""
    arm = np.einsum('tji,tj->ti', chest, -upper[..., 1])
    elevation = np.arccos(np.clip(-arm[:, 1], -1.0, 1.0))
    rise = _BLADE_FRACTION * np.maximum(0.0, elevation - np.radians(_BLADE_START))
    forward = np.radians(_FORWARD_SHOULDER) * arm[:, 2]
    return chest @ axis_rotation(2, side * rise) @ axis_rotation(1, -side * forward)


def _local(
    body: BodyModel, standing: NDArray[np.float64], named: dict[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return relative rotations; bones that are not named are as in the standing pose."""
    rotations = np.empty((len(named['root']), len(body.bones), 3, 3))
    orientations = np.empty_like(rotations)
    for bone, parent in enumerate(body.parents):
        orientation = named.get(str(body.bones[bone]))
        if parent < 0:
            orientations[:, bone] = rotations[:, bone] = named['root'] @ standing[bone]
            continue
        if orientation is None:
            rotations[:, bone] = standing[parent].T @ standing[bone]
            orientations[:, bone] = orientations[:, parent] @ rotations[:, bone]
        else:
            orientations[:, bone] = orientation @ standing[bone]
            rotations[:, bone] = orientations[:, parent].transpose(0, 2, 1) @ orientations[:, bone]
    return rotations
