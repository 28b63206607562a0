"""The node's estimator: loaded, and warmed up before the first image comes."""

from pathlib import Path

import numpy as np

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.estimator import Estimator
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.core.skeletons import Skeletons
from lsc_pose_ros.data.model_file import load_model
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources import default_model
from lsc_pose_ros.ros.parameters import Parameters

_DISTANCE = 2.0
_CAMERA = Intrinsics(285.0, 285.0, 160.0, 120.0)

# A figure in an image of 320 x 240: head, trunk with arms spread, legs. Top, bottom, left, right.
_FIGURE = ((20, 50, 148, 172), (50, 130, 135, 185), (58, 70, 70, 250), (130, 220, 137, 155),
           (130, 220, 165, 183))  # fmt: skip


def load_estimator(parameters: Parameters) -> Estimator:
    """Return the estimator that `parameters` ask for.

    Raises:
        InputError: there is no such model, or it cannot be read.
    """
    try:
        path = Path(parameters.model) if parameters.model else default_model()
    except InputError as error:
        msg = f'parameter model: {error}'
        raise InputError(msg) from error
    return Estimator(load_model(path), graph=parameters.graph)


def warm_up(estimator: Estimator) -> Skeletons:
    """Let `estimator` look at a drawn figure, so that all its kernels are compiled.

    Returns:
        what it sees in it.
    """
    depth = np.zeros((240, 320), np.float32)
    labels = np.full((240, 320), NO_BODY, np.int32)
    for top, bottom, left, right in _FIGURE:
        depth[top:bottom, left:right] = _DISTANCE
        labels[top:bottom, left:right] = 1
    return estimator.estimate(depth, labels, _CAMERA)
