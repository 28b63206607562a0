# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""A trained model: its joints and edges, settings, forest, confidence and provenance."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.forest.body_yaw import BODY_YAW_SIZE
from lsc_pose_ros.pose.forest.forest import Forest
from lsc_pose_ros.pose.inference.confidence import uncalibrated
from lsc_pose_ros.pose.settings import Settings


class Model(NamedTuple):
    """A trained model.

    Attributes:
        joints: the numbers of the joints that it estimates, shape (J,).
        edges: pairs (parent, child) of indices into `joints`, shape (E, 2).
        limb_lengths: the mean length of each edge in training, metres, shape (E,) (h_ij).
        settings: the parameters of the method.
        forest: the trees and the votes in their leaves.
        provenance: the training data and options, for people to read.
        calibration: the confidence in each joint for K vote fractions, evenly from 0 to 1, shape
            (J, K); or (0, K) if unknown: then the vote fraction is the confidence.
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
        """The number of features of a point that the trees can split by."""
        return feature_size(self.settings) + (BODY_YAW_SIZE if self.settings.body_yaws else 0)
