"""One motion capture file as a person's motion: how every segment is turned, frame by frame."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.mocap.bvh import Bvh, Placed, load_bvh, place_joints
from lsc_pose_ros.synthetic.mocap.mocap_limbs import (
    ELBOW,
    KNEE,
    Lines,
    bends_backwards,
    flip_limb,
    limit_foot,
    limit_hand,
    limit_part,
    turn_limb,
    unbend,
)
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, MocapMapping, Source
from lsc_pose_ros.synthetic.motion.rotations import (
    about,
    between,
    frames_along,
    half_turn,
    to_quaternions,
    unit,
)

RATE = 30.0
"""Files of more frames a second are thinned to no less than this."""

_FASTEST = 1800.0
"""Degrees a second at which a segment can turn; faster is an error of the capture."""


class Clip(NamedTuple):
    """A person's motion in T frames.

    Attributes:
        turns: how each segment is turned from the straight stance, in the axes of a person who
            faces forward, quaternions (w, x, y, z), shape (T, S, 4).
        shoulders: whether the shoulders' turns were captured.
        heading: where the person faces, radians to the left, not wrapped, shape (T,).
        sound: whether limbs are bent as people's can be, and do not jump, shape (T,).
        rate: frames a second.
    """

    turns: NDArray[np.float32]
    shoulders: bool
    heading: NDArray[np.float64]
    sound: NDArray[np.bool_]
    rate: float


def read_clip(path: Path, mapping: MocapMapping) -> Clip:
    """Return the motion in the BVH file `path`.

    Raises:
        InputError: the file is damaged, lacks joints or frames that the mapping names, or nobody
            can move so.
    """
    bvh = load_bvh(path)
    _check(path, bvh, mapping)
    step = max(1, int(1.0 / (RATE * bvh.frame_time) + 1e-3))
    chosen = bvh.values[mapping.skip :: step]
    capture = _Capture(bvh, mapping, chosen)
    turns, sound = _turn_segments(capture)
    heading = _heading(turns)
    away = about(1, -heading)
    stacked = np.stack([away @ turns[name] for name in SEGMENTS], axis=1)
    quaternions = to_quaternions(stacked)
    rate = 1.0 / (bvh.frame_time * step)
    sound &= _steady(quaternions, heading, rate)
    if not sound.any():
        msg = (
            f'{path}: nobody can move as {mapping.path} has it; '
            'is it the mapping for this file? check its axes and its neutral pose'
        )
        raise InputError(msg)
    shoulders = 'l_shoulder' in mapping.segments
    return Clip(quaternions.astype(np.float32), shoulders, heading, sound, rate)


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
    """What was captured, in the axes of a person who looks ahead in the neutral pose."""

    def __init__(self, bvh: Bvh, mapping: MocapMapping, values: NDArray[np.float64]) -> None:
        self.segments = mapping.segments
        neutral = np.zeros((1, bvh.values.shape[1]))
        if mapping.neutral is not None:
            neutral = bvh.values[mapping.neutral : mapping.neutral + 1]
        start = place_joints(bvh._replace(values=neutral))
        placed: Placed = place_joints(bvh._replace(values=values))
        self._numbers = {name: number for number, name in enumerate(bvh.names)}
        self._turns = (
            mapping.axes @ (placed.turns @ start.turns[0].transpose(0, 2, 1)) @ mapping.axes.T
        )
        self._positions = placed.positions @ mapping.axes.T
        self._start = start.positions[0] @ mapping.axes.T

    def turn(self, name: str) -> NDArray[np.float64]:
        """Return how a segment is turned from the straight stance, shape (T, 3, 3)."""
        source = self.segments[name]
        if source.along:
            return frames_along(self.line(source.along), self.ahead(source))
        x, y, z = np.radians(source.at_rest)
        return self._joint_turns(source.turns) @ about(1, y) @ about(0, x) @ about(2, z)

    def line(self, joints: tuple[str, ...]) -> NDArray[np.float64]:
        """Return the direction from one joint to another, shape (T, 3)."""
        start, end = (self._positions[:, self._numbers[name]] for name in joints)
        return unit(end - start)

    def lines(self, parent: NDArray[np.float64], upper: str, lower: str) -> Lines:
        """Return a limb's two parts; `parent` is how the trunk above it is turned."""
        above, below = self.segments[upper], self.segments[lower]
        return Lines(parent, self.line(above.along), self.line(below.along), self.ahead(above))

    def too_bent(self, upper: str, lower: str) -> float:
        """Return by how much more a hinge is bent in the file than in truth, radians."""
        above, below = self.segments[upper], self.segments[lower]
        if below.bent is None:
            return 0.0
        first, second = (
            unit(self._start[self._numbers[end]] - self._start[self._numbers[start]])
            for start, end in (above.along, below.along)
        )
        return float(np.arccos(np.clip(first @ second, -1.0, 1.0)) - np.radians(below.bent))

    def ahead(self, source: Source) -> NDArray[np.float64]:
        """Return the direction of what is ahead of a limb, shape (T, 3)."""
        if source.across:
            return self.line(source.across)
        return self._joint_turns(source.along[0])[..., 2]

    def _joint_turns(self, joint: str) -> NDArray[np.float64]:
        turns: NDArray[np.float64] = self._turns[:, self._numbers[joint]]
        return turns


_Turns = dict[str, NDArray[np.float64]]


def _turn_segments(capture: _Capture) -> tuple[_Turns, NDArray[np.bool_]]:
    """Return each segment's turn, heading and all, and which frames are sound."""
    turns = _turn_trunk(capture)
    sound = np.ones(len(turns['pelvis']), np.bool_)
    for letter, side in (('l', 1.0), ('r', -1.0)):
        sound &= _turn_arm(capture, turns, letter, side)
        sound &= _turn_leg(capture, turns, letter, side)
    return turns, sound


def _turn_trunk(capture: _Capture) -> _Turns:
    turns = {name: capture.turn(name) for name in ('pelvis', 'chest')}
    turns['chest'] = limit_part(turns['pelvis'], turns['chest'], 90.0)
    for name, below, above in (('waist', 'pelvis', 'chest'), ('head', 'chest', 'chest')):
        mapped = name in capture.segments
        middle = capture.turn(name) if mapped else between(turns[below], turns[above], 0.5)
        turns[name] = limit_part(turns[below], middle, 80.0)
    mapped = 'neck' in capture.segments
    neck = capture.turn('neck') if mapped else between(turns['chest'], turns['head'], 0.5)
    turns['neck'] = limit_part(turns['chest'], neck, 50.0)
    return turns


def _turn_arm(capture: _Capture, turns: _Turns, letter: str, side: float) -> NDArray[np.bool_]:
    shoulder, upper, lower, end = (
        f'{letter}_{name}' for name in ('shoulder', 'upper_arm', 'forearm', 'hand')
    )
    mapped = shoulder in capture.segments
    turns[shoulder] = capture.turn(shoulder) if mapped else turns['chest']
    lines = capture.lines(turns['chest'], upper, lower)
    flipped = bends_backwards(lines, ELBOW, side)
    if flipped:
        lines = flip_limb(lines)
    # A hinge that is bent backwards has too little of what the others have too much.
    lines = unbend(lines, (-1 if flipped else 1) * capture.too_bent(upper, lower))
    limb = turn_limb(lines, ELBOW, side)
    turns[upper], turns[lower] = limb.upper, limb.lower
    hand = limb.lower
    if end in capture.segments:
        hand = capture.turn(end)
        if flipped:
            hand = half_turn(lines.lower) @ half_turn(lines.upper) @ hand
    turns[end] = limit_hand(limb.lower, hand)
    return limb.sound


def _turn_leg(capture: _Capture, turns: _Turns, letter: str, side: float) -> NDArray[np.bool_]:
    upper, lower, end = (f'{letter}_{name}' for name in ('thigh', 'shank', 'foot'))
    lines = capture.lines(turns['pelvis'], upper, lower)
    limb = turn_limb(unbend(lines, capture.too_bent(upper, lower)), KNEE, side)
    turns[upper], turns[lower] = limb.upper, limb.lower
    foot = capture.turn(end) if end in capture.segments else limb.lower
    turns[end] = limit_foot(limb.lower, foot)
    return limb.sound


def _heading(turns: _Turns) -> NDArray[np.float64]:
    """Return where the person faces, radians to the left of forward, not wrapped, shape (T,).

    Across the way from right to left, of pelvis and chest together: that is level in people who
    bend down or lie on their backs, too. Where it is not, the frames around say it.
    """
    left = turns['pelvis'][..., 0] + turns['chest'][..., 0]
    level = np.hypot(left[:, 0], left[:, 2]) > 0.5
    if not level.any():
        return np.zeros(len(left))
    frames = np.flatnonzero(level)
    heading = np.unwrap(np.arctan2(-left[frames, 2], left[frames, 0]))
    return np.asarray(np.interp(np.arange(len(left)), frames, heading))


def _steady(
    quaternions: NDArray[np.float64], heading: NDArray[np.float64], rate: float
) -> NDArray[np.bool_]:
    """Return which frames differ from those beside them by no more than people can move."""
    cosine = np.abs((quaternions[1:] * quaternions[:-1]).sum(axis=-1))
    turned = 2 * np.arccos(np.clip(cosine, 0.0, 1.0)).max(axis=1)
    turned = np.maximum(turned, np.abs(np.diff(heading)))
    jumps = np.round(turned * rate, 6) > np.radians(_FASTEST)
    steady = np.ones(len(quaternions), np.bool_)
    steady[1:] &= ~jumps
    steady[:-1] &= ~jumps
    return steady
