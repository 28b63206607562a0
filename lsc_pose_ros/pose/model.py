"""A trained model: which joints, how they hang together, the forest, and where it comes from."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.forest.body_yaw import BODY_YAW_SIZE
from lsc_pose_ros.pose.forest.forest import Forest
from lsc_pose_ros.pose.inference.confidence import uncalibrated
from lsc_pose_ros.pose.settings import Settings


class Model(NamedTuple):
    """All that estimation needs.

    Attributes:
        joints: the numbers of the joints that it estimates, shape (J,).
        edges: pairs (parent, child) of indices into `joints`, shape (E, 2).
        limb_lengths: the mean length of each edge in training, metres, shape (E,) (h_ij).
        settings: how silhouettes, descriptors and densities are computed.
        forest: the trees and their votes.
        provenance: what it was trained on and how, for people to read.
        calibration: the confidence in each joint at K shares of the votes, evenly from 0 to 1,
            shape (J, K); or (0, K) where it is not known, then the share is the confidence.
    """

    joints: NDArray[np.uint16]
    edges: NDArray[np.int32]
    limb_lengths: NDArray[np.float32]
    settings: Settings
    forest: Forest
    provenance: dict[str, str]
    calibration: NDArray[np.float32] = uncalibrated()

    @property
    def feature_size(self) -> int:
        """How many numbers about a point the forest of the joints can ask for."""
        return feature_size(self.settings) + (BODY_YAW_SIZE if self.settings.body_yaws else 0)
