"""How a person moves: random key poses, and smooth ways from one to the next.

Key poses, and ways between them, on which a limb would go through the body are drawn anew.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data.synthetic.body import Body
from lsc_pose_ros.data.synthetic.overlap import deepest_overlap
from lsc_pose_ros.data.synthetic.pose import ANGLES
from lsc_pose_ros.data.synthetic.postures import draw_key

KEY_SECONDS = (0.35, 0.9)
"""The shortest and the longest time from one key pose to the next."""

DEEPEST = 0.025
"""How far skin may sink into skin, metres: flesh and clothes give way."""

_CANDIDATES = 12  # ways to a next key pose that are drawn and checked at a time
_ROUNDS = 4
_CHECKS = 6  # poses on each way


class Motion(NamedTuple):
    """What a person does in T frames.

    Attributes:
        angles: radians, shape (T, A).
        yaw: where the person faces, radians, 0 towards the camera, positive to the person's
            left, shape (T,).
    """

    angles: NDArray[np.float64]
    yaw: NDArray[np.float64]


def draw_motion(
    body: Body, count: int, rate: float, widest_yaw: float, random: np.random.Generator
) -> Motion:
    """Draw what `body` does in `count` frames at `rate` frames a second.

    Args:
        body: the person.
        count: frames.
        rate: frames a second.
        widest_yaw: the person never faces further aside than this, radians.
        random: the source of chance.

    Returns:
        A smooth motion: speed and acceleration are zero at every key pose.
    """
    times = _key_times(count / rate, random)
    keys = [_next_key(body, None, random)]
    for _ in times[1:]:
        keys.append(_next_key(body, keys[-1], random))
    yaws = _key_yaws(len(times), widest_yaw, random)
    frame_times = np.arange(count) / rate
    return Motion(
        interpolate(frame_times, times, np.array(keys)),
        interpolate(frame_times, times, yaws[:, None])[:, 0],
    )


def interpolate(
    times: NDArray[np.float64], key_times: NDArray[np.float64], keys: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return values at `times`, shape (T,), on the way through `keys`, shape (K, A).

    Each way has minimum jerk, as human reaching has: s = 10 u^3 - 15 u^4 + 6 u^5 (Flash and Hogan,
    1985). It never leaves the range between its two keys, so it keeps limits that they keep.
    """
    last = np.clip(np.searchsorted(key_times, times, side='right') - 1, 0, len(keys) - 2)
    span = key_times[last + 1] - key_times[last]
    u = np.clip((times - key_times[last]) / span, 0.0, 1.0)[:, None]
    share = u**3 * (10 - 15 * u + 6 * u**2)
    values: NDArray[np.float64] = keys[last] + share * (keys[last + 1] - keys[last])
    return values


def _key_times(seconds: float, random: np.random.Generator) -> NDArray[np.float64]:
    """Draw when key poses are reached, from 0 to at least `seconds`."""
    shortest, longest = KEY_SECONDS
    times = [0.0]
    while len(times) < 2 or times[-1] < seconds:
        times.append(times[-1] + shortest + (longest - shortest) * random.random())
    return np.array(times)


def _key_yaws(count: int, widest: float, random: np.random.Generator) -> NDArray[np.float64]:
    """Draw where the person faces at each key: anywhere, then turning by up to 25 degrees."""
    first = widest * (2 * random.random() - 1)
    turns = np.radians(25) * (2 * random.random(count - 1) - 1)
    yaws = [first]
    for turn in turns:
        yaws.append(float(np.clip(yaws[-1] + turn, -widest, widest)))
    return np.array(yaws)


def _next_key(
    body: Body, previous: NDArray[np.float64] | None, random: np.random.Generator
) -> NDArray[np.float64]:
    """Draw a key pose that can be reached from `previous` without going through the body."""
    best, least = np.zeros(len(ANGLES)), np.inf
    for _ in range(_ROUNDS):
        keys = np.array([draw_key(random) for _ in range(_CANDIDATES)])
        shares = np.linspace(0, 1, _CHECKS + 1)[1:] if previous is not None else np.ones(1)
        origin = np.zeros(len(ANGLES)) if previous is None else previous
        ways = origin + shares[None, :, None] * (keys - origin)[:, None]
        overlap = deepest_overlap(body, ways.reshape(-1, len(ANGLES)))
        overlap = overlap.reshape(_CANDIDATES, len(shares)).max(axis=1)
        # Rounded, so that the last bits, which differ between libraries, do not choose.
        overlap = np.round(np.maximum(overlap, DEEPEST), 6)
        candidate = int(np.argmin(overlap))
        if overlap[candidate] < least:
            best, least = keys[candidate], float(overlap[candidate])
        if least <= DEEPEST:
            break
    return best
