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

"""Joint angles of a pose by clinical convention, and the limits of the joints.

All angles are zero in a person who stands straight with hanging arms, thumbs forwards.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel

TRUNK_ANGLES: tuple[str, ...] = (
    'lean', 'list', 'bend', 'side', 'twist', 'nod', 'tilt', 'turn',
)  # fmt: skip
ARM_ANGLES: tuple[str, ...] = (
    'plane', 'elevation', 'axial', 'elbow', 'pronation', 'wrist_flexion', 'wrist_deviation',
    'shrug', 'fingers',
)  # fmt: skip
LEG_ANGLES: tuple[str, ...] = (
    'hip_flexion', 'hip_abduction', 'hip_rotation', 'knee', 'ankle', 'eversion', 'toes',
)  # fmt: skip

ANGLES: tuple[str, ...] = TRUNK_ANGLES + tuple(
    f'{side}_{name}' for side in ('l', 'r') for name in ARM_ANGLES + LEG_ANGLES
)
ANGLE_NUMBERS: dict[str, int] = {name: number for number, name in enumerate(ANGLES)}

# Degrees. The limits follow the American Academy of Orthopaedic Surgeons, Joint Motion:
# Method of Measuring and Recording (1965): thoracolumbar spine 80 flexion, 25 extension, 35
# lateral, 45 rotation; neck 45, 45, 60; shoulder 180 elevation, 60 extension, rotation 70 inwards
# and 90 outwards; elbow 150; forearm 80 each way; wrist 80 flexion, 70 extension, 20 radial, 30
# ulnar; fingers 90 at the knuckles; hip 120 flexion, 30 extension, 45 abduction, 30 adduction,
# rotation 45; knee 135; ankle 20 dorsal, 50 plantar; foot 35 inversion, 15 eversion; toes 70.
# Under the body's weight, the ankle allows 38 (Bennell et al., 1998). `lean` and `list` tilt the
# pelvis and so the whole person; their limits are our choice.
LIMITS: dict[str, tuple[float, float]] = {
    'lean': (-35, 95),  # forwards
    'list': (-20, 20),  # sideways, to the person's left
    'bend': (-25, 70),
    'side': (-30, 30),
    'twist': (-45, 45),
    'nod': (-45, 45),
    'tilt': (-35, 35),
    'turn': (-60, 60),
    'plane': (-90, 125),  # the plane of elevation: 0 sideways, 90 forwards
    'elevation': (0, 172),
    'axial': (-70, 90),  # of the upper arm, outwards
    'elbow': (0, 148),
    'pronation': (-80, 80),
    'wrist_flexion': (-65, 70),
    'wrist_deviation': (-30, 20),  # to the little finger's side, and to the thumb's
    'shrug': (-8, 20),  # added to the shoulder's rise with the arm
    'fingers': (-5, 90),  # each of the joints of a closing hand
    'hip_flexion': (-28, 120),
    'hip_abduction': (-25, 50),
    'hip_rotation': (-40, 45),  # outwards
    'knee': (0, 138),
    'ankle': (-36, 50),  # plantar
    'eversion': (-30, 18),
    'toes': (-10, 60),  # upwards
}

_BEHIND = 60.0  # limit of the elevation straight backwards, degrees
_ACROSS = 110.0  # limit across the chest, degrees


def _slices(first: int, length: int) -> tuple[slice, slice]:
    other = first + len(ARM_ANGLES) + len(LEG_ANGLES)
    return slice(first, first + length), slice(other, other + length)


ARMS: tuple[slice, slice] = _slices(len(TRUNK_ANGLES), len(ARM_ANGLES))
"""The slices of the left and of the right arm's angles in a pose."""

LEGS: tuple[slice, slice] = _slices(len(TRUNK_ANGLES) + len(ARM_ANGLES), len(LEG_ANGLES))
"""The slices of the left and of the right leg's angles in a pose."""


def _limits() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    pairs = [LIMITS[name if name in TRUNK_ANGLES else name.partition('_')[2]] for name in ANGLES]
    low, high = np.radians(np.array(pairs, dtype=np.float64)).T
    return low, high


LOWER_LIMITS, UPPER_LIMITS = _limits()
"""The lower and the upper limit of each of ANGLES, radians, shape (A,) each."""


def within_limits(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `angles`, radians, shape (..., A), clipped to the limits of the joints.

    The limit of the arm's elevation depends on its plane: it is lower behind the back and across
    the chest than sideways and forwards.
    """
    kept: NDArray[np.float64] = np.clip(angles, LOWER_LIMITS, UPPER_LIMITS)
    for arm in ARMS:
        plane, elevation = arm.start, arm.start + 1
        sideways = UPPER_LIMITS[elevation]
        highest = np.interp(
            kept[..., plane],
            np.radians([-90, 0, 90, 130]),
            [np.radians(_BEHIND), sideways, sideways, np.radians(_ACROSS)],
        )
        kept[..., elevation] = np.minimum(kept[..., elevation], highest)
    return kept


@kernel
def max_elevation(plane: float, sideways: float) -> float:
    """Return the limit of an arm's elevation in a plane, given the one sideways, radians."""
    if plane < 0:
        fraction = max(1 + plane / np.radians(90), 0.0)
        return float(np.radians(_BEHIND) + fraction * (sideways - np.radians(_BEHIND)))
    fraction = min(max(plane / np.radians(90) - 1, 0.0) * 90 / 40, 1.0)
    return float(sideways - fraction * (sideways - np.radians(_ACROSS)))


def arms_to_cartesian(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return poses, shape (..., A), with plane and elevation of the arms in Cartesian form.

    The Cartesian form is elevation times cosine and sine of the plane: the parts sideways and
    forwards. The plane is undefined and jumps when an arm swings past hanging; this form does not.
    """
    return _convert_arms(angles, lambda plane, up: (up * np.cos(plane), up * np.sin(plane)))


def arms_to_polar(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return poses, shape (..., A), with plane and elevation of the arms in polar form.

    This is the inverse of `arms_to_cartesian`.
    """
    return _convert_arms(
        angles, lambda left, ahead: (np.arctan2(ahead, left), np.hypot(left, ahead))
    )


def _convert_arms(
    angles: NDArray[np.float64],
    swap: Callable[
        [NDArray[np.float64], NDArray[np.float64]],
        tuple[NDArray[np.float64], NDArray[np.float64]],
    ],
) -> NDArray[np.float64]:
    swapped = angles.copy()
    for arm in ARMS:
        first = arm.start  # of plane and elevation
        pair = swap(angles[..., first], angles[..., first + 1])
        swapped[..., first], swapped[..., first + 1] = pair
    return swapped


def mirrored(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mirror image of poses, shape (..., A): left and right are exchanged."""
    mirror = angles.copy()
    for limbs in (ARMS, LEGS):
        mirror[..., limbs[0]], mirror[..., limbs[1]] = angles[..., limbs[1]], angles[..., limbs[0]]
    for name in ('list', 'side', 'twist', 'tilt', 'turn'):
        mirror[..., ANGLE_NUMBERS[name]] *= -1
    return mirror
