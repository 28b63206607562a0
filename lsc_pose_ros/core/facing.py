"""Where a person faces, as a number that joins the descriptors, so that trees can split by it."""

import numpy as np
from numpy.typing import NDArray

FACING_SIZE = 2
"""How many numbers the facing adds to a descriptor: its cosine and its sine."""


def facing_of(across: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return where people face, radians, shape (...): 0 towards the camera, up to pi away from it.

    Args:
        across: from the right to the left shoulder or hip in the optical frame, shape (..., 3);
            positive angles face to image right.
    """
    line = np.asarray(across, np.float64)
    facing: NDArray[np.float64] = np.arctan2(line[..., 2], line[..., 0])
    return facing


def facings_around(count: int) -> NDArray[np.float64]:
    """Return so many directions, evenly around the circle, radians, shape (count,)."""
    return (np.arange(count, dtype=np.float64) + 0.5) * (2 * np.pi / count) - np.pi


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
