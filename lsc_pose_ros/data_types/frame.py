"""One frame as the method sees it: depth in metres, who is where, and the camera."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons

NO_BODY = -1
"""The label of a pixel that shows no body."""


class Frame(NamedTuple):
    """A depth image with its mask and camera, and the true skeletons where they are known.

    Attributes:
        stamp: nanoseconds, the depth image's own.
        frame_id: the camera's optical frame.
        depth: metres, 0 where the sensor saw nothing, shape (H, W), float32.
        labels: the number of the body that a pixel shows, or NO_BODY, shape (H, W), int32.
        camera: the intrinsics.
        ground_truth: the labelled skeletons, or None.
    """

    stamp: int
    frame_id: str
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    camera: Intrinsics
    ground_truth: Skeletons | None
