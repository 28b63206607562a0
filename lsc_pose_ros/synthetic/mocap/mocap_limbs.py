"""Arms and legs from the directions of their parts, as joints allow them.

In motion capture the directions of limbs are sound, but how limbs are turned about themselves is
often not: there it flips by half a turn or drifts. A bent elbow or knee, which is a hinge, shows
that turn; where the limb is straight, the captured turn is taken if a joint can do it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.motion.rotations import (
    about,
    frames_along,
    from_rotation_vectors,
    half_turn,
    rotation_vectors,
    swing,
    unit,
)


class Hinge(NamedTuple):
    """What an elbow or a knee, and the shoulder or hip above it, can do.

    Attributes:
        bend: whether the lower part bends forwards, 1, or backwards, -1, where the limb hangs.
        inwards: how far the upper part turns about itself inwards, degrees.
        outwards: and outwards.
    """

    bend: float
    inwards: float
    outwards: float


# A little more than the clinical ranges (American Academy of Orthopaedic Surgeons, 1965:
# shoulder 70 inwards, 90 outwards; hip 45 each way), since the blade and the pelvis give way.
ELBOW = Hinge(1.0, 90.0, 110.0)
KNEE = Hinge(-1.0, 60.0, 60.0)

_SLACK = 25.0
"""Degrees beyond a hinge's range at which what was captured is not believed any more."""

_STRAIGHT, _BENT = 10.0, 35.0
"""Degrees between which a bend takes over as what shows a limb's turn about itself."""

_CLEAR = 40.0
"""A bend, degrees, at which a limb that bends the wrong way cannot be an error of straightness."""


class Limb(NamedTuple):
    """An upper and a lower arm, or thigh and shank, in T frames.

    Attributes:
        upper: turns from the straight stance, shape (T, 3, 3).
        lower: of the part below the hinge.
        sound: whether a joint can do this, shape (T,).
    """

    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    sound: NDArray[np.bool_]


class Lines(NamedTuple):
    """A limb as captured in T frames.

    Attributes:
        parent: turns of the chest or pelvis, shape (T, 3, 3).
        upper: direction of the upper part, shape (T, 3).
        lower: of the lower part.
        carried: what was ahead of the upper part in the neutral pose, turned as it is.
    """

    parent: NDArray[np.float64]
    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    carried: NDArray[np.float64]


def bends_backwards(lines: Lines, hinge: Hinge, side: float) -> bool:
    """Return whether in most frames the limb bends the way in which no hinge does.

    A clip is flipped as a whole when the capture took the elbow for bent the other way.
    """
    bent = _bend(lines) > np.radians(_CLEAR)
    return bool(2 * (bent & ~_believed(_shown(lines, hinge), hinge, side)).sum() > bent.sum())


def flip_limb(lines: Lines) -> Lines:
    """Return the limb with its lower part turned about the upper one by half a turn."""
    return lines._replace(lower=np.einsum('tij,tj->ti', half_turn(lines.upper), lines.lower))


def unbend(lines: Lines, angle: float) -> Lines:
    """Return the limb with its hinge bent by `angle`, radians, less, straight at most."""
    along = (lines.upper * lines.lower).sum(axis=-1, keepdims=True)
    across = unit(lines.lower - along * lines.upper)
    bend = np.maximum(_bend(lines) - angle, 0.0)[:, None]
    return lines._replace(lower=np.cos(bend) * lines.upper + np.sin(bend) * across)


def turn_limb(lines: Lines, hinge: Hinge, side: float) -> Limb:
    """Return how the two parts are turned.

    Args:
        lines: what was captured.
        hinge: what it can do.
        side: 1 for the left, -1 for the right limb.
    """
    bend, shown = _bend(lines), _shown(lines, hinge)
    sound = (bend <= np.radians(_CLEAR)) | _believed(shown, hinge, side)
    share = _ramp(bend)
    carried = _about_itself(lines, lines.carried)
    carried = carried + _usual_difference(shown, carried, bend)
    carried = np.where(_believed(carried, hinge, side), carried, 0.0)
    mixed = share * np.exp(1j * shown) + (1 - share) * np.exp(1j * carried)
    low, high = _range(hinge, side, 0.0)
    angle = np.clip(np.angle(mixed), low, high)
    upper = _hanging(lines) @ about(1, angle)
    # The hinge's axis is the same to both parts.
    axis = upper[..., 0]
    return Limb(upper, frames_along(lines.lower, np.cross(axis, -lines.lower)), sound)


def limit_hand(forearm: NDArray[np.float64], hand: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return hands' turns, (T, 3, 3), within what wrists and forearms allow."""
    local = np.swapaxes(forearm, -1, -2) @ hand
    down = np.broadcast_to([0.0, -1.0, 0.0], local.shape[:-1])
    bent = swing(down, -local[..., 1])
    rest = np.swapaxes(bent, -1, -2) @ local
    twist = np.arctan2(rest[..., 0, 2], rest[..., 2, 2])
    # A palm that is turned nearly back to front was captured back to front.
    twist = np.where(np.abs(twist) > np.radians(120), twist - np.sign(twist) * np.pi, twist)
    twist = np.clip(twist, *np.radians([-90, 90]))
    return forearm @ _no_further(bent, 70.0) @ about(1, twist)


def limit_foot(shank: NDArray[np.float64], foot: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return feet's turns, (T, 3, 3), within what ankles allow."""
    vectors = rotation_vectors(np.swapaxes(shank, -1, -2) @ foot)
    far = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True)) > np.radians(110)
    low, high = np.radians([[-35, -30, -30], [60, 30, 30]])  # plantar flexion is positive
    return shank @ from_rotation_vectors(np.where(far, 0.0, np.clip(vectors, low, high)))


def limit_part(
    below: NDArray[np.float64], above: NDArray[np.float64], most: float
) -> NDArray[np.float64]:
    """Return the turns `above`, (T, 3, 3), by no more than `most` degrees from `below`."""
    return below @ _no_further(np.swapaxes(below, -1, -2) @ above, most)


def _no_further(rotations: NDArray[np.float64], most: float) -> NDArray[np.float64]:
    vectors = rotation_vectors(rotations)
    angle = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    share = np.minimum(1.0, np.radians(most) / np.maximum(angle, 1e-9))
    return from_rotation_vectors(share * vectors)


def _hanging(lines: Lines) -> NDArray[np.float64]:
    """Return the upper part's turn if it swung there from hanging, not turning about itself."""
    hanging: NDArray[np.float64] = swing(-lines.parent[..., 1], lines.upper) @ lines.parent
    return hanging


def _about_itself(lines: Lines, ahead: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return by how much the upper part is turned about itself if `ahead` is ahead of it."""
    seen = np.einsum('tji,tj->ti', _hanging(lines), ahead)
    return np.asarray(np.arctan2(seen[:, 0], seen[:, 2]))


def _shown(lines: Lines, hinge: Hinge) -> NDArray[np.float64]:
    """Return the upper part's turn about itself, as the bent hinge shows it."""
    return _about_itself(lines, hinge.bend * lines.lower)


def _bend(lines: Lines) -> NDArray[np.float64]:
    sine = np.cross(lines.upper, lines.lower)
    cosine = (lines.upper * lines.lower).sum(axis=-1)
    return np.asarray(np.arctan2(np.sqrt((sine * sine).sum(axis=-1)), cosine))


def _ramp(bend: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = np.radians([_STRAIGHT, _BENT])
    share = np.clip((bend - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))


def _range(hinge: Hinge, side: float, slack: float) -> tuple[float, float]:
    inwards, outwards = np.radians([hinge.inwards + slack, hinge.outwards + slack])
    return (-inwards, outwards) if side > 0 else (-outwards, inwards)


def _believed(angle: NDArray[np.float64], hinge: Hinge, side: float) -> NDArray[np.bool_]:
    low, high = _range(hinge, side, _SLACK)
    wrapped = np.angle(np.exp(1j * angle))
    return np.asarray((wrapped >= low) & (wrapped <= high))


def _usual_difference(
    shown: NDArray[np.float64], carried: NDArray[np.float64], bend: NDArray[np.float64]
) -> float:
    """Return by how much the captured turn usually misses the one that the hinge shows."""
    weight = np.where(bend > np.radians(_BENT), np.sin(bend) ** 2, 0.0)
    return float(np.angle((weight * np.exp(1j * (shown - carried))).sum()))
