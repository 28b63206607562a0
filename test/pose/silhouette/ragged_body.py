"""A body full of what makes silhouettes hard: holes, steps, a ragged rim."""

import numpy as np

from lsc_pose_ros.data_types.frame import NO_BODY


def ragged_body(seed: int, shape: tuple[int, int] = (40, 60)) -> tuple[np.ndarray, np.ndarray]:
    """Return the depth of body 3, with holes and steps, and its labels."""
    rng = np.random.default_rng(seed)
    depth = rng.choice([2.0, 2.03, 2.2, 3.0], shape) + rng.normal(0, 0.01, shape)
    depth[rng.random(shape) < 0.1] = 0
    labels = np.where(rng.random(shape) < 0.7, 3, NO_BODY).astype(np.int32)
    return depth.astype(np.float32), labels
