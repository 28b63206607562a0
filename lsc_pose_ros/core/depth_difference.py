"""Depth comparison features: DCF, a rival of the paper's feature.

J. Shotton et al., "Real-time human pose recognition in parts from single depth images", CVPR
2011, eq. 1: f(I, x) = d(x + u / d(x)) - d(x + v / d(x)), the difference of the depths at two
offsets from a pixel; what is not the body is very far away. There each split draws its own pairs
(u, v); here the pairs are a pool, drawn once, from which the splits draw, so that they are
numbered features like the bins of a histogram.
"""

import random
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.core.silhouette import Window

# How large the pool is and how far offsets reach are settings. On real people, learnt from 600 and
# 2,000 frames, pools of 300 to 2,000 pairs differ by no more than other seeds do, so there are as
# many pairs as the paper's feature has bins. Offsets up to 0.25, 0.5 and 0.8 m differ little; with
# the middle one the mean error is least, by 0.2 and 0.5 cm.

# What a probe beside the body finds, metres.
FAR = 10.0

# A difference is kept as the byte MIDDLE + difference / DEPTH_STEP: +-1 m, more than an arm
# stretched to the camera, to 8 mm, less than a sensor's noise. One probe beside the body gives an
# end of the scale, both give MIDDLE.
DEPTH_STEP = 0.008
MIDDLE = 128


@lru_cache(maxsize=8)
def offset_pool(pairs: int, reach: float, seed: int) -> NDArray[np.float32]:
    """Return pairs of random offsets as (u_x, u_y, v_x, v_y) in metres, shape (pairs, 4).

    Offsets are drawn evenly from the square of half side `reach`. An offset in metres, times the
    focal length and divided by the depth, is one in pixels, whatever the camera. In every other
    pair v is 0: the point itself is compared.

    Args:
        pairs: how many.
        reach: how far an offset reaches in x and in y, metres.
        seed: of the draws.
    """
    # Python's own generator, since its `random` gives the same numbers in every version: a model
    # carries the seed and not the pool.
    draw = random.Random(seed).random  # noqa: S311 - nothing secret
    pool = np.array([[draw() for _ in range(4)] for _ in range(pairs)])
    pool = reach * (2 * pool - 1)
    pool[1::2, 2:] = 0
    pool = pool.astype(np.float32)
    pool.flags.writeable = False  # it is handed out again and again
    return pool


@kernel
def compare_depths(
    window: Window,
    pixels: NDArray[np.int32],
    pool: NDArray[np.float32],
    camera: Intrinsics,
) -> NDArray[np.uint8]:
    """Return the depth comparisons of some of the body's pixels as levels, shape (Q, pairs).

    A level is MIDDLE + (d(x + u f / d(x)) - d(x + v f / d(x))) / DEPTH_STEP, rounded and clipped
    to a byte; d is FAR beside the body and beside the image.

    Args:
        window: the body.
        pixels: row and column in the window, each on the body, shape (Q, 2).
        pool: pairs of offsets, metres, shape (pairs, 4).
        camera: the intrinsics.
    """
    levels = np.empty((pixels.shape[0], pool.shape[0]), np.uint8)
    for q in range(pixels.shape[0]):
        row, column = pixels[q, 0], pixels[q, 1]
        depth = window.depth[row, column]
        per_metre_x, per_metre_y = camera.fx / depth, camera.fy / depth
        for k in range(pool.shape[0]):
            first = _probe(
                window.depth, row + pool[k, 1] * per_metre_y, column + pool[k, 0] * per_metre_x
            )
            second = _probe(
                window.depth, row + pool[k, 3] * per_metre_y, column + pool[k, 2] * per_metre_x
            )
            level = np.floor((first - second) / DEPTH_STEP + (MIDDLE + 0.5))
            levels[q, k] = np.uint8(min(max(level, 0.0), 255.0))
    return levels


@kernel
def _probe(depth: NDArray[np.float32], row: float, column: float) -> float:
    """Return the depth at the pixel nearest to a place in the window."""
    # Compared as numbers with a fraction: far out they are no integers any more.
    row, column = np.floor(row + 0.5), np.floor(column + 0.5)
    if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
        return FAR
    found = depth[int(row), int(column)]
    return float(found) if np.isfinite(found) else FAR
