"""A frame: depth in metres, the label image and the camera."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons

NO_BODY = -1
"""The label of a pixel that shows no body."""


class Frame(NamedTuple):
    """A depth image with its label image, its camera and, if known, its ground truth.

    Attributes:
        stamp: the stamp of the depth image, nanoseconds.
        frame_id: the name of the camera's optical frame (REP-103).
        depth: metres, 0 if the sensor measured nothing, shape (H, W), float32.
        labels: the number of the body that a pixel shows, or NO_BODY, shape (H, W), int32.
        camera: the intrinsics of the depth image.
        ground_truth: the labelled skeletons, or None.
    """

    stamp: int
    frame_id: str
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    camera: Intrinsics
    ground_truth: Skeletons | None
