"""Compiles what estimation needs before the first frame comes, or loads it from the disk."""

import numpy as np

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.estimator import Estimator
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.core.rvl import decode_rvl
from lsc_pose_ros.core.skeletons import Skeletons

_DISTANCE = 2.0
_CAMERA = Intrinsics(285.0, 285.0, 160.0, 120.0)

# A figure in an image of 320 x 240: head, trunk with arms spread, legs. Top, bottom, left, right.
_FIGURE = ((20, 50, 148, 172), (50, 130, 135, 185), (58, 70, 70, 250), (130, 220, 137, 155),
           (130, 220, 165, 183))  # fmt: skip

# RVL for four pixels that are 0.
_EMPTY_RVL = bytes((0, 0, 0, 0x40))


def warm_up(estimator: Estimator) -> Skeletons:
    """Let `estimator` look at a drawn figure, so that all kernels for its frames are compiled.

    Those that read a compressed depth image are, too.

    Returns:
        what it sees in the figure, body 1.
    """
    depth = np.zeros((240, 320), np.float32)
    labels = np.full((240, 320), NO_BODY, np.int32)
    for top, bottom, left, right in _FIGURE:
        depth[top:bottom, left:right] = _DISTANCE
        labels[top:bottom, left:right] = 1
    decode_rvl(_EMPTY_RVL, 4)
    return estimator.estimate(depth, labels, _CAMERA)
