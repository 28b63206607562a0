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

"""Orientations of arms and legs from the directions of their parts, within joint limits.

Motion capture gives reliable directions of limbs, but often a wrong axial rotation, which flips by
half a turn or drifts. A bent elbow or knee is a hinge, so it determines the axial rotation. In a
straight limb, the captured axial rotation is used if it is within the limits of the joint.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.geometry.rotations import (
    axis_rotation,
    from_rotation_vectors,
    half_turns,
    limb_frames,
    normalised,
    rotation_vectors,
    shortest_rotation,
)


class Hinge(NamedTuple):
    """Limits of an elbow or knee and of the shoulder or hip above it.

    Attributes:
        bend: whether the lower part of a hanging limb bends forwards, 1, or backwards, -1.
        inwards: limit of the upper part's axial rotation inwards, degrees.
        outwards: limit of the upper part's axial rotation outwards, degrees.
    """

    bend: float
    inwards: float
    outwards: float


# Slightly more than the clinical ranges (American Academy of Orthopaedic Surgeons, 1965:
# shoulder 70 inwards, 90 outwards; hip 45 each way), because shoulder blade and pelvis move too.
ELBOW = Hinge(1.0, 90.0, 110.0)
KNEE = Hinge(-1.0, 60.0, 60.0)

_SLACK = 25.0
"""Tolerance of the limits for captured axial rotations, degrees."""

_STRAIGHT, _BENT = 10.0, 35.0
"""Between these bends, degrees, the weight of the hinge's axial rotation rises from 0 to 1."""

_CLEAR = 40.0
"""From this bend on, degrees, a limb that bends the wrong way is a capture error."""


class Limb(NamedTuple):
    """Upper and lower arm, or thigh and shank, in T frames.

    Attributes:
        upper: orientations relative to the standing pose, shape (T, 3, 3).
        lower: orientations of the part below the hinge, shape (T, 3, 3).
        valid: whether a joint can do this, shape (T,).
    """

    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    valid: NDArray[np.bool_]


class LimbDirections(NamedTuple):
    """The captured directions of a limb in T frames.

    Attributes:
        parent: orientations of the chest or pelvis, shape (T, 3, 3).
        upper: direction of the upper part, shape (T, 3).
        lower: direction of the lower part, shape (T, 3).
        ahead: captured direction that is ahead of the upper part, shape (T, 3).
    """

    parent: NDArray[np.float64]
    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    ahead: NDArray[np.float64]


def bends_backwards(directions: LimbDirections, hinge: Hinge, side: float) -> bool:
    """Return whether the limb bends in the impossible direction in most frames.

    If so, the capture assumed the wrong side of the elbow, and the whole clip is flipped.
    """
    bent = _bend(directions) > np.radians(_CLEAR)
    return bool(
        2 * (bent & ~_is_plausible(_axial_from_hinge(directions, hinge), hinge, side)).sum()
        > bent.sum()
    )


def flip_limb(directions: LimbDirections) -> LimbDirections:
    """Return the limb with its lower part rotated about the upper one by half a turn."""
    return directions._replace(
        lower=np.einsum('tij,tj->ti', half_turns(directions.upper), directions.lower)
    )


def unbend(directions: LimbDirections, angle: float) -> LimbDirections:
    """Return the limb with its hinge bent less by `angle`, radians, but not beyond straight."""
    along = (directions.upper * directions.lower).sum(axis=-1, keepdims=True)
    across = normalised(directions.lower - along * directions.upper)
    bend = np.maximum(_bend(directions) - angle, 0.0)[:, None]
    return directions._replace(lower=np.cos(bend) * directions.upper + np.sin(bend) * across)


def orient_limb(directions: LimbDirections, hinge: Hinge, side: float) -> Limb:
    """Return the orientations of both parts.

    Args:
        directions: the captured directions.
        hinge: its limits.
        side: 1 for the left, -1 for the right limb.
    """
    bend, from_hinge = _bend(directions), _axial_from_hinge(directions, hinge)
    valid = (bend <= np.radians(_CLEAR)) | _is_plausible(from_hinge, hinge, side)
    fraction = _hinge_weight(bend)
    captured = _axial_rotation(directions, directions.ahead)
    captured = captured + _mean_offset(from_hinge, captured, bend)
    captured = np.where(_is_plausible(captured, hinge, side), captured, 0.0)
    mixed = fraction * np.exp(1j * from_hinge) + (1 - fraction) * np.exp(1j * captured)
    low, high = _axial_range(hinge, side, 0.0)
    angle = np.clip(np.angle(mixed), low, high)
    upper = _hanging(directions) @ axis_rotation(1, angle)
    # Both parts share the hinge's axis.
    axis = upper[..., 0]
    return Limb(upper, limb_frames(directions.lower, np.cross(axis, -directions.lower)), valid)


def limit_hand(forearm: NDArray[np.float64], hand: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the hands' orientations, (T, 3, 3), within the limits of wrists and forearms."""
    local = np.swapaxes(forearm, -1, -2) @ hand
    down = np.broadcast_to([0.0, -1.0, 0.0], local.shape[:-1])
    bent = shortest_rotation(down, -local[..., 1])
    rest = np.swapaxes(bent, -1, -2) @ local
    twist = np.arctan2(rest[..., 0, 2], rest[..., 2, 2])
    # A palm that is nearly reversed was captured reversed.
    twist = np.where(np.abs(twist) > np.radians(120), twist - np.sign(twist) * np.pi, twist)
    twist = np.clip(twist, *np.radians([-90, 90]))
    return forearm @ _limit_angle(bent, 70.0) @ axis_rotation(1, twist)


def limit_foot(shank: NDArray[np.float64], foot: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the feet's orientations, (T, 3, 3), within the limits of the ankles."""
    vectors = rotation_vectors(np.swapaxes(shank, -1, -2) @ foot)
    far = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True)) > np.radians(110)
    low, high = np.radians([[-35, -30, -30], [60, 30, 30]])  # plantar flexion is positive
    return shank @ from_rotation_vectors(np.where(far, 0.0, np.clip(vectors, low, high)))


def limit_segment(
    below: NDArray[np.float64], above: NDArray[np.float64], most: float
) -> NDArray[np.float64]:
    """Return the orientations `above`, (T, 3, 3), at most `most` degrees from `below`."""
    return below @ _limit_angle(np.swapaxes(below, -1, -2) @ above, most)


def _limit_angle(rotations: NDArray[np.float64], most: float) -> NDArray[np.float64]:
    vectors = rotation_vectors(rotations)
    angle = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    fraction = np.minimum(1.0, np.radians(most) / np.maximum(angle, 1e-9))
    return from_rotation_vectors(fraction * vectors)


def _hanging(directions: LimbDirections) -> NDArray[np.float64]:
    """Return the upper part's orientation without axial rotation from the hanging pose."""
    hanging: NDArray[np.float64] = (
        shortest_rotation(-directions.parent[..., 1], directions.upper) @ directions.parent
    )
    return hanging


def _axial_rotation(directions: LimbDirections, ahead: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the upper part's axial rotation at which `ahead` is ahead of it."""
    seen = np.einsum('tji,tj->ti', _hanging(directions), ahead)
    return np.asarray(np.arctan2(seen[:, 0], seen[:, 2]))


def _axial_from_hinge(directions: LimbDirections, hinge: Hinge) -> NDArray[np.float64]:
    """Return the upper part's axial rotation that the bent hinge determines."""
    return _axial_rotation(directions, hinge.bend * directions.lower)


def _bend(directions: LimbDirections) -> NDArray[np.float64]:
    sine = np.cross(directions.upper, directions.lower)
    cosine = (directions.upper * directions.lower).sum(axis=-1)
    return np.asarray(np.arctan2(np.sqrt((sine * sine).sum(axis=-1)), cosine))


def _hinge_weight(bend: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = np.radians([_STRAIGHT, _BENT])
    fraction = np.clip((bend - low) / (high - low), 0.0, 1.0)
    return np.asarray(fraction * fraction * (3 - 2 * fraction))


def _axial_range(hinge: Hinge, side: float, slack: float) -> tuple[float, float]:
    inwards, outwards = np.radians([hinge.inwards + slack, hinge.outwards + slack])
    return (-inwards, outwards) if side > 0 else (-outwards, inwards)


def _is_plausible(angle: NDArray[np.float64], hinge: Hinge, side: float) -> NDArray[np.bool_]:
    low, high = _axial_range(hinge, side, _SLACK)
    wrapped = np.angle(np.exp(1j * angle))
    return np.asarray((wrapped >= low) & (wrapped <= high))


def _mean_offset(
    from_hinge: NDArray[np.float64], captured: NDArray[np.float64], bend: NDArray[np.float64]
) -> float:
    """Return the circular mean of the difference between both axial rotations in bent limbs."""
    weight = np.where(bend > np.radians(_BENT), np.sin(bend) ** 2, 0.0)
    return float(np.angle((weight * np.exp(1j * (from_hinge - captured))).sum()))
