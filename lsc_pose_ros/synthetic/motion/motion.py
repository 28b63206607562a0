"""What synthetic people do: poses that have nothing to do with each other, or smooth motion.

Poses, and ways between them, on which a limb would go through the body are drawn anew.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest
from lsc_pose_ros.synthetic.body.bone_rotations import articulate
from lsc_pose_ros.synthetic.body.self_collision import (
    DEEPEST,
    Mannequin,
    deepest_overlap,
    mannequin_of,
)
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.joint_angles import planes, swings, within_limits
from lsc_pose_ros.synthetic.motion.lower_body_poses import Stance
from lsc_pose_ros.synthetic.motion.whole_body_poses import draw_gesture, draw_pose, overlap
from lsc_pose_ros.synthetic.sampling import Chances

KEY_SECONDS = (0.35, 0.9)
"""The shortest and the longest time from one key pose to the next, unless the way is long."""

FASTEST = np.radians(250)
"""An angle changes no more than this in a second from one key pose to the next, on an average."""

_TURNING = np.radians(40)  # a second
_TRIES = 12  # poses, or ways to a next key pose, that are drawn before the best is taken
_CHECKS = 6  # poses on each way
_OUTSIDE = np.radians(10)
_STRIDE_KEYS = 10
_FIRST_STEPS = 4


class Motion(NamedTuple):
    """What a person does in T frames.

    Attributes:
        rotations: of the bones against their parents, as `pose_body` takes them, shape
            (T, B, 3, 3); the root's has no yaw: the person faces +z, more or less.
        yaw: where the person faces, radians, 0 towards the camera, positive to the person's
            left, shape (T,).
    """

    rotations: NDArray[np.float64]
    yaw: NDArray[np.float64]


def draw_motion(
    body: Body,
    rest: Rest,
    count: int,
    rate: float | None,
    widest_yaw: float,
    random: np.random.Generator,
) -> Motion:
    """Draw what a person does in `count` frames.

    Args:
        body: everybody's body.
        rest: the person at rest.
        count: frames.
        rate: frames a second; None draws poses that have nothing to do with each other.
        widest_yaw: the person never faces further aside than this, radians.
        random: the source of chance.

    Returns:
        The motion; at a rate it is smooth: its speed has no leaps.
    """
    mannequin = mannequin_of(body, rest)
    if rate is None:
        poses = [_draw_any(mannequin, random) for _ in range(count)]
        angles = np.array([pose.angles for pose in poses])
        yaw = widest_yaw * (2 * random.random(count) - 1)
    else:
        angles, yaw = _draw_smooth(mannequin, np.arange(count) / rate, widest_yaw, random)
    return Motion(articulate(mannequin.rig, angles), yaw)


def interpolate(
    times: NDArray[np.float64], key_times: NDArray[np.float64], keys: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return values at `times`, shape (T,), on the way through `keys`, shape (K, A), K > 1.

    Cubic Hermite polynomials whose slopes at the keys are weighted harmonic means of the slopes
    on both sides, and zero where the value turns (Fritsch and Butland, 1984). No value leaves the
    range between its two keys, so limits that keys keep are kept.
    """
    spans = np.diff(key_times)[:, None]
    steps = np.diff(keys, axis=0) / spans
    before, after = steps[:-1], steps[1:]
    weight = (spans[:-1] + 2 * spans[1:]) / (3 * (spans[:-1] + spans[1:]))
    onwards = before * after > 0
    mean = np.where(onwards, weight * after + (1 - weight) * before, 1.0)
    slopes = np.zeros_like(keys)
    slopes[1:-1] = np.where(onwards, before * after / mean, 0.0)
    last = np.clip(np.searchsorted(key_times, times, side='right') - 1, 0, len(keys) - 2)
    span = spans[last]
    u = np.clip((times[:, None] - key_times[last, None]) / span, 0.0, 1.0)
    share = u * u * (3 - 2 * u)
    values: NDArray[np.float64] = (
        keys[last]
        + share * (keys[last + 1] - keys[last])
        + span * u * (1 - u) * ((1 - u) * slopes[last] - u * slopes[last + 1])
    )
    return values


def _draw_smooth(
    mannequin: Mannequin,
    times: NDArray[np.float64],
    widest_yaw: float,
    random: np.random.Generator,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angles, shape (T, A), and yaw, (T,), at `times`, shape (T,)."""
    keys = _Keys(mannequin, random)
    while len(keys.times) < 2 or keys.times[-1] < times[-1]:
        keys.act()
    key_times = np.array(keys.times)
    yaws = _key_yaws(key_times, widest_yaw, random)
    way = interpolate(times, key_times, swings(np.array([pose.angles for pose in keys.poses])))
    yaw = interpolate(times, key_times, yaws[:, None])[:, 0]
    return within_limits(planes(way)), yaw


def _key_yaws(
    times: NDArray[np.float64], widest: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Draw where the person faces at each key: anywhere, then turning a little."""
    chances = 2 * random.random(len(times)) - 1
    yaws = [widest * chances[0]]
    for chance, span in zip(chances[1:], np.diff(times), strict=True):
        yaws.append(float(np.clip(yaws[-1] + _TURNING * span * chance, -widest, widest)))
    return np.array(yaws)


def _draw_any(mannequin: Mannequin, random: np.random.Generator) -> Stance:
    """Draw a pose, whatever was before."""
    return _draw_clear(mannequin, None, lambda chances: draw_pose(mannequin, chances), random)


def _draw_clear(
    mannequin: Mannequin,
    before: NDArray[np.float64] | None,
    draw: Callable[[Chances], Stance],
    random: np.random.Generator,
) -> Stance:
    """Draw a pose, to be reached from the one before, if any, without going through the body.

    If none is found, the one of which the way goes least deep is taken.
    """
    drawn: list[tuple[float, Stance]] = []
    for _ in range(_TRIES):
        pose = draw(Chances(random))
        if before is None:
            depth = overlap(mannequin, pose)
        else:
            depth = _depth_of_way(mannequin, before, pose.angles)
        if depth <= DEEPEST:
            return pose
        drawn.append((depth, pose))
    return min(drawn, key=lambda each: each[0])[1]


def _depth_of_way(
    mannequin: Mannequin, before: NDArray[np.float64], after: NDArray[np.float64]
) -> float:
    """Return how deep limbs go through the body on the way between two poses, metres.

    It is infinite if an arm would have to go where joints do not allow.
    """
    start, end = swings(before), swings(after)
    way = planes(start + np.linspace(0, 1, _CHECKS + 1)[1:, None] * (end - start))
    if np.abs(within_limits(way) - way).max() > _OUTSIDE:
        return np.inf
    # Rounded, so that the last bits, which differ between libraries, do not choose poses.
    return round(float(deepest_overlap(mannequin, way).max()), 6)


class _Keys:
    """Key poses, strung together as a person goes from one to the next."""

    def __init__(self, mannequin: Mannequin, random: np.random.Generator) -> None:
        self._mannequin = mannequin
        self._random = random
        self.times = [0.0]
        self.poses = [_draw_any(mannequin, random)]

    def act(self) -> None:
        """Add what the person does next."""
        chances = Chances(self._random)
        chances.choose(
            ((0.4, self._gesture), (0.2, self._repeat), (0.28, self._move), (0.12, self._walk))
        )(chances)

    def _add(self, pose: Stance, seconds: float) -> None:
        change = np.abs(swings(pose.angles) - swings(self.poses[-1].angles)).max()
        self.times.append(self.times[-1] + max(seconds, float(change) / FASTEST))
        self.poses.append(pose)

    def _next(self, draw: Callable[[Mannequin, Chances], Stance]) -> Stance:
        return _draw_clear(
            self._mannequin,
            self.poses[-1].angles,
            lambda chances: draw(self._mannequin, chances),
            self._random,
        )

    def _draw_gesture(self, mannequin: Mannequin, chances: Chances) -> Stance:
        return draw_gesture(mannequin, self.poses[-1], chances)

    def _gesture(self, chances: Chances) -> None:
        self._add(self._next(self._draw_gesture), chances.between(*KEY_SECONDS))

    def _move(self, chances: Chances) -> None:
        self._add(self._next(draw_pose), chances.between(*KEY_SECONDS))

    def _repeat(self, chances: Chances) -> None:
        """Go to another gesture and back, a few times: wave, box, clap."""
        here, there = self.poses[-1], self._next(self._draw_gesture)
        seconds = chances.between(0.2, 0.6)
        for _ in range(int(chances.between(1, 4))):
            self._add(there, seconds)
            self._add(here, seconds)

    def _walk(self, chances: Chances) -> None:
        """Walk or run some strides; a stride takes 1.1 s of who walks, 0.7 s of who runs."""
        running = chances.choose(((0.6, 0.0), (0.2, 0.5), (0.2, 1.0)))
        size, hand = chances.between(0.7, 1.15), np.radians(chances.near(0, 10))
        count = int(_STRIDE_KEYS * chances.between(1, 3))
        step = (1.1 - 0.4 * running) * chances.between(0.9, 1.15) / _STRIDE_KEYS

        def at(phase: float) -> Stance:
            angles = stride_angles(phase % 1.0, running, size, hand)
            return Stance('walk', within_limits(angles))

        # The first step is the one that is easiest to begin with.
        before = self.poses[-1].angles
        first = min(
            (chances.share() for _ in range(_FIRST_STEPS)),
            key=lambda phase: _depth_of_way(self._mannequin, before, at(phase).angles),
        )
        self._add(at(first), chances.between(*KEY_SECONDS))
        for key in range(1, count):
            self._add(at(first + key / _STRIDE_KEYS), step)
