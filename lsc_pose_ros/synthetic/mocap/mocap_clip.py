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

"""A person's motion from one motion capture file: the orientation of each segment over time."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.geometry.rotations import (
    axis_rotation,
    half_turns,
    interpolate_rotations,
    limb_frames,
    normalised,
    to_quaternions,
)
from lsc_pose_ros.synthetic.mocap.bvh import Bvh, JointPoses, joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.mocap_limbs import (
    ELBOW,
    KNEE,
    LimbDirections,
    bends_backwards,
    flip_limb,
    limit_foot,
    limit_hand,
    limit_segment,
    orient_limb,
    unbend,
)
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, MocapMapping, SegmentSource

RATE = 30.0
"""Target frame rate, Hz: files with a higher rate are subsampled to no less than this."""

_FASTEST = 1800.0
"""Largest angular speed of a segment, degrees per second; higher ones are capture errors."""


class MocapClip(NamedTuple):
    """A person's motion in T frames.

    Attributes:
        orientations: of each segment relative to the standing pose, in the axes of a person who
            faces forward, quaternions (w, x, y, z), shape (T, S, 4).
        shoulders: whether the shoulders were captured.
        heading: direction that the person faces, radians to the left, not wrapped, shape (T,).
        valid: whether the limbs are within the limits of the joints and do not jump, shape (T,).
        rate: frames per second.
    """

    orientations: NDArray[np.float32]
    shoulders: bool
    heading: NDArray[np.float64]
    valid: NDArray[np.bool_]
    rate: float


def read_clip(path: Path, mapping: MocapMapping) -> MocapClip:
    """Return the motion of the BVH file `path`.

    Raises:
        InputError: the file is damaged, does not have the joints or frames of the mapping, or
            shows an impossible motion.
    """
    bvh = load_bvh(path)
    _check(path, bvh, mapping)
    step = max(1, int(1.0 / (RATE * bvh.frame_time) + 1e-3))
    chosen = bvh.values[mapping.skip :: step]
    capture = _Capture(bvh, mapping, chosen)
    orientations, valid = _orient_segments(capture)
    heading = _heading(orientations)
    away = axis_rotation(1, -heading)
    stacked = np.stack([away @ orientations[name] for name in SEGMENTS], axis=1)
    quaternions = to_quaternions(stacked)
    rate = 1.0 / (bvh.frame_time * step)
    valid &= _is_steady(quaternions, heading, rate)
    if not valid.any():
        msg = (
            f'{path}: with the mapping {mapping.path} no frame shows a possible pose; '
            'check that it is the mapping for this file, its axes and its neutral pose'
        )
        raise InputError(msg)
    shoulders = 'l_shoulder' in mapping.segments
    return MocapClip(quaternions.astype(np.float32), shoulders, heading, valid, rate)


def _check(path: Path, bvh: Bvh, mapping: MocapMapping) -> None:
    missing = [name for name in dict.fromkeys(mapping.joints) if name not in bvh.names]
    if missing:
        msg = (
            f'{path} has no joint {", ".join(missing)}, which the mapping {mapping.path} names; '
            f'its joints are {", ".join(bvh.names)}'
        )
        raise InputError(msg)
    needed = max(mapping.skip, -1 if mapping.neutral is None else mapping.neutral) + 1
    if len(bvh.values) < needed:
        msg = f'{path} has {len(bvh.values)} frames; the mapping {mapping.path} needs {needed}'
        raise InputError(msg)


class _Capture:
    """The captured joints, in the axes of a person who looks ahead in the neutral pose."""

    def __init__(self, bvh: Bvh, mapping: MocapMapping, values: NDArray[np.float64]) -> None:
        self.segments = mapping.segments
        neutral = np.zeros((1, bvh.values.shape[1]))
        if mapping.neutral is not None:
            neutral = bvh.values[mapping.neutral : mapping.neutral + 1]
        start = joint_poses(bvh._replace(values=neutral))
        captured: JointPoses = joint_poses(bvh._replace(values=values))
        self._numbers = {name: number for number, name in enumerate(bvh.names)}
        self._orientations = (
            mapping.axes
            @ (captured.orientations @ start.orientations[0].transpose(0, 2, 1))
            @ mapping.axes.T
        )
        self._positions = captured.positions @ mapping.axes.T
        self._start = start.positions[0] @ mapping.axes.T

    def orientation(self, name: str) -> NDArray[np.float64]:
        """Return the orientation of a segment relative to the standing pose, shape (T, 3, 3)."""
        source = self.segments[name]
        if source.along:
            return limb_frames(self.line(source.along), self.ahead(source))
        x, y, z = np.radians(source.at_rest)
        return (
            self._joint_orientations(source.turns)
            @ axis_rotation(1, y)
            @ axis_rotation(0, x)
            @ axis_rotation(2, z)
        )

    def line(self, joints: tuple[str, ...]) -> NDArray[np.float64]:
        """Return the direction from one joint to another, shape (T, 3)."""
        start, end = (self._positions[:, self._numbers[name]] for name in joints)
        return normalised(end - start)

    def limb(self, parent: NDArray[np.float64], upper: str, lower: str) -> LimbDirections:
        """Return the directions of a limb; `parent` is the orientation of the chest or pelvis."""
        above, below = self.segments[upper], self.segments[lower]
        return LimbDirections(
            parent, self.line(above.along), self.line(below.along), self.ahead(above)
        )

    def excess_bend(self, upper: str, lower: str) -> float:
        """Return by how much a hinge is bent more in the file than in reality, radians."""
        above, below = self.segments[upper], self.segments[lower]
        if below.bent is None:
            return 0.0
        first, second = (
            normalised(self._start[self._numbers[end]] - self._start[self._numbers[start]])
            for start, end in (above.along, below.along)
        )
        return float(np.arccos(np.clip(first @ second, -1.0, 1.0)) - np.radians(below.bent))

    def ahead(self, source: SegmentSource) -> NDArray[np.float64]:
        """Return the direction that is ahead of a limb, shape (T, 3)."""
        if source.across:
            return self.line(source.across)
        return self._joint_orientations(source.along[0])[..., 2]

    def _joint_orientations(self, joint: str) -> NDArray[np.float64]:
        orientations: NDArray[np.float64] = self._orientations[:, self._numbers[joint]]
        return orientations


_Orientations = dict[str, NDArray[np.float64]]


def _orient_segments(capture: _Capture) -> tuple[_Orientations, NDArray[np.bool_]]:
    """Return each segment's orientation, heading included, and which frames are valid."""
    orientations = _set_trunk(capture)
    valid = np.ones(len(orientations['pelvis']), np.bool_)
    for letter, side in (('l', 1.0), ('r', -1.0)):
        valid &= _set_arm(capture, orientations, letter, side)
        valid &= _set_leg(capture, orientations, letter, side)
    return orientations, valid


def _set_trunk(capture: _Capture) -> _Orientations:
    orientations = {name: capture.orientation(name) for name in ('pelvis', 'chest')}
    orientations['chest'] = limit_segment(orientations['pelvis'], orientations['chest'], 90.0)
    for name, below, above in (('waist', 'pelvis', 'chest'), ('head', 'chest', 'chest')):
        mapped = name in capture.segments
        middle = (
            capture.orientation(name)
            if mapped
            else interpolate_rotations(orientations[below], orientations[above], 0.5)
        )
        orientations[name] = limit_segment(orientations[below], middle, 80.0)
    mapped = 'neck' in capture.segments
    neck = (
        capture.orientation('neck')
        if mapped
        else interpolate_rotations(orientations['chest'], orientations['head'], 0.5)
    )
    orientations['neck'] = limit_segment(orientations['chest'], neck, 50.0)
    return orientations


def _set_arm(
    capture: _Capture, orientations: _Orientations, letter: str, side: float
) -> NDArray[np.bool_]:
    shoulder, upper, lower, end = (
        f'{letter}_{name}' for name in ('shoulder', 'upper_arm', 'forearm', 'hand')
    )
    mapped = shoulder in capture.segments
    orientations[shoulder] = capture.orientation(shoulder) if mapped else orientations['chest']
    directions = capture.limb(orientations['chest'], upper, lower)
    flipped = bends_backwards(directions, ELBOW, side)
    if flipped:
        directions = flip_limb(directions)
    # In a flipped limb, the excess has the opposite sign.
    directions = unbend(directions, (-1 if flipped else 1) * capture.excess_bend(upper, lower))
    limb = orient_limb(directions, ELBOW, side)
    orientations[upper], orientations[lower] = limb.upper, limb.lower
    hand = limb.lower
    if end in capture.segments:
        hand = capture.orientation(end)
        if flipped:
            hand = half_turns(directions.lower) @ half_turns(directions.upper) @ hand
    orientations[end] = limit_hand(limb.lower, hand)
    return limb.valid


def _set_leg(
    capture: _Capture, orientations: _Orientations, letter: str, side: float
) -> NDArray[np.bool_]:
    upper, lower, end = (f'{letter}_{name}' for name in ('thigh', 'shank', 'foot'))
    directions = capture.limb(orientations['pelvis'], upper, lower)
    limb = orient_limb(unbend(directions, capture.excess_bend(upper, lower)), KNEE, side)
    orientations[upper], orientations[lower] = limb.upper, limb.lower
    foot = capture.orientation(end) if end in capture.segments else limb.lower
    orientations[end] = limit_foot(limb.lower, foot)
    return limb.valid


def _heading(orientations: _Orientations) -> NDArray[np.float64]:
    """Return the direction that the person faces, radians to the left, not wrapped, shape (T,).

    It is orthogonal to the lateral axes of pelvis and chest, which are level even in people who
    bend down or lie. In frames in which they are not, it is interpolated.
    """
    left = orientations['pelvis'][..., 0] + orientations['chest'][..., 0]
    level = np.hypot(left[:, 0], left[:, 2]) > 0.5
    if not level.any():
        return np.zeros(len(left))
    frames = np.flatnonzero(level)
    heading = np.unwrap(np.arctan2(-left[frames, 2], left[frames, 0]))
    return np.asarray(np.interp(np.arange(len(left)), frames, heading))


def _is_steady(
    quaternions: NDArray[np.float64], heading: NDArray[np.float64], rate: float
) -> NDArray[np.bool_]:
    """Return which frames differ from their neighbours by no more than people can move."""
    cosine = np.abs((quaternions[1:] * quaternions[:-1]).sum(axis=-1))
    angles = 2 * np.arccos(np.clip(cosine, 0.0, 1.0)).max(axis=1)
    angles = np.maximum(angles, np.abs(np.diff(heading)))
    jumps = np.round(angles * rate, 6) > np.radians(_FASTEST)
    steady = np.ones(len(quaternions), np.bool_)
    steady[1:] &= ~jumps
    steady[:-1] &= ~jumps
    return steady
