"""Constant offsets between a model's joints and those of other labels.

Every data set puts its joints in other places of the body: a Kinect's hips lie far above those of
a skeleton that was fitted to markers. One offset a joint takes that away and nothing else, so that
what is left is the model's own error.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.evaluation.evaluate import Evaluation


def fit_offsets(evaluation: Evaluation) -> NDArray[np.float32]:
    """Return the median over all people of truth minus estimate, metres, shape (J, 3).

    Each axis of the camera frame is taken for itself: the median, since single estimates are far
    off. NaN for a joint that is nowhere both labelled and estimated.
    """
    differences = evaluation.differences
    offsets = np.full(differences.shape[1:], np.nan, np.float32)
    for j in range(differences.shape[1]):
        known = differences[:, j][~np.isnan(differences[:, j]).any(axis=1)]
        if len(known):
            offsets[j] = np.median(known, axis=0)
    return offsets


def apply_offsets(evaluation: Evaluation, offsets: NDArray[np.float32]) -> Evaluation:
    """Return `evaluation` as it is when `offsets` are added to every estimate.

    Args:
        evaluation: of the estimates as they are.
        offsets: metres, in the camera frame, shape (J, 3); NaN leaves a joint as it is.
    """
    differences = evaluation.differences - np.nan_to_num(offsets)
    errors: NDArray[np.float32] = np.linalg.norm(differences, axis=-1).astype(np.float32)
    # What is not labelled stays NaN, and what was not estimated infinite.
    estimated = np.isfinite(evaluation.errors)
    return evaluation._replace(
        errors=np.where(estimated, errors, evaluation.errors), differences=differences
    )
