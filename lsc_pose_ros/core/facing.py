"""Where a person faces, told by a forest of its own, so that the other one can ask for it.

Seen from behind, a person has the left hand where, seen from before, the right one would be, and
the surroundings of a single point hardly tell which it is. All points together do: each falls into
a leaf of a few small trees that knows which way the people of its samples faced, and what the
leaves say adds up. The answer joins each point's descriptor, so that the forest of the joints can
split by it. Such a forest, conditioned on what all of the body tells, is that of Sun, Kohli and
Shotton, Conditional regression forests for human pose estimation (CVPR 2012). It goes beyond the
paper.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.forest import find_leaves
from lsc_pose_ros.core.jit import kernel

SECTORS = 8
"""Into how many directions the trees divide the full circle."""

FACING_SIZE = 2
"""How many numbers the facing adds to a descriptor: its cosine and its sine."""

STEP = 1 / 16
"""Of the evidence in the leaves, nats."""

# The points of a body are neighbours and say much the same, so all that they say together counts
# as if only so many had been asked.
_WITNESSES = 20.0


# What lies below the middle of the body, or above its shoulders, in units of rho_bar and upwards,
# tells where the person faces. Trunk and arms look alike from both sides, but small differences
# between people's clothes and those of the training made them sure of the wrong one.
_MIDDLE, _SHOULDERS = 0.0, 0.55


class FacingForest(NamedTuple):
    """T trees over descriptors, nodes as in Forest; their leaves know where people face.

    Attributes:
        roots, feature, threshold, left: as in Forest.
        evidence: log p(sector | leaf) - log p(sector) in units of STEP, shape (L, SECTORS).
    """

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]
    evidence: NDArray[np.int8]


def sector_centres() -> NDArray[np.float64]:
    """Return the directions in the middle of the sectors, radians, shape (SECTORS,)."""
    return (np.arange(SECTORS, dtype=np.float64) + 0.5) * (2 * np.pi / SECTORS) - np.pi


def sector_of(angle: NDArray[np.floating]) -> NDArray[np.int64]:
    """Return the sectors that directions, radians, any shape, lie in."""
    turned = (np.asarray(angle, np.float64) + np.pi) * (SECTORS / (2 * np.pi))
    sectors: NDArray[np.int64] = np.floor(turned).astype(np.int64) % SECTORS
    return sectors


def facing_of(across: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return where people face, radians, shape (...): 0 towards the camera, up to pi away from it.

    Args:
        across: from the right to the left shoulder or hip in the optical frame, shape (..., 3);
            positive angles face to image right.
    """
    line = np.asarray(across, np.float64)
    facing: NDArray[np.float64] = np.arctan2(line[..., 2], line[..., 0])
    return facing


def are_witnesses(points: NDArray[np.float32], scale: float) -> NDArray[np.bool_]:
    """Tell which points are asked where the person faces: legs and head, shape (N,).

    Args:
        points: of one person in the optical frame, any unit, shape (N, 3).
        scale: rho_bar in that unit.
    """
    height = (points[:, 1].mean() - points[:, 1]) / np.float32(scale)
    asked: NDArray[np.bool_] = (height < _MIDDLE) | (height > _SHOULDERS)
    return asked if asked.any() else np.ones(len(points), np.bool_)


def find_facing(forest: FacingForest, levels: NDArray[np.uint8]) -> float:
    """Return where the person faces, radians, as `facing_of`.

    The leaves' evidence is summed over points and trees; the answer is the mean direction under
    the probabilities that follow.

    Args:
        forest: the trees.
        levels: the descriptors of those of the person's points that are asked, shape (Q, F).
    """
    votes = _sum_evidence(forest, find_leaves(forest, levels))
    evidence = votes * (STEP * _WITNESSES / max(1, len(levels) * len(forest.roots)))
    shares = np.exp(evidence - evidence.max())
    centres = sector_centres()
    return math.atan2(float(shares @ np.sin(centres)), float(shares @ np.cos(centres)))


def turned_round(facing: float) -> float:
    """Return where people face whose outline is the same, but who are seen from the other side."""
    return math.atan2(math.sin(facing), -math.cos(facing))


def with_facing(levels: NDArray[np.uint8], facing: float) -> NDArray[np.uint8]:
    """Return descriptors, shape (Q, F), with the facing as two more levels, (Q, F + 2)."""
    joined = np.empty((len(levels), levels.shape[1] + FACING_SIZE), np.uint8)
    joined[:, :-FACING_SIZE] = levels
    joined[:, -FACING_SIZE:] = facing_levels(np.array([facing]))[0]
    return joined


def facing_levels(facing: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the levels, shape (P, 2), that say that people face there, radians, shape (P,)."""
    pair = np.stack([np.cos(facing), np.sin(facing)], axis=1)
    return np.rint(127.5 + 127.0 * pair).astype(np.uint8)


@kernel
def _sum_evidence(forest: FacingForest, leaves: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return the evidence for each sector over all leaves, shape (SECTORS,)."""
    total = np.zeros(SECTORS, np.int64)
    for point in range(leaves.shape[0]):
        for tree in range(leaves.shape[1]):
            for sector in range(SECTORS):
                total[sector] += forest.evidence[leaves[point, tree], sector]
    return total
