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

"""Estimates joints as Shotton et al."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.body_by_body import estimate_bodies
from lsc_pose_experiments.shotton.joint_proposals import (
    ProposalSettings,
    push_back,
    surface_proposal,
)
from lsc_pose_experiments.shotton.part_forest import PartForest
from lsc_pose_experiments.shotton.part_pixels import classify_body, part_cloud
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.image_arguments import ImageArguments, check_images
from lsc_pose_ros.data_types.skeletons import Skeletons


class PartModel(NamedTuple):
    """What the training learns.

    Attributes:
        joints: the numbers of the joints, shape (J,).
        forest: classifies pixels.
        proposals: the settings of the part of each joint, J of them.
    """

    joints: NDArray[np.uint16]
    forest: PartForest
    proposals: tuple[ProposalSettings, ...]


class PartEstimator:
    """Estimates each joint from the pixels of its body part, without a model of the body."""

    def __init__(self, model: PartModel) -> None:
        """Prepare the estimation with a trained model."""
        self._model = model

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""
        return self._model.joints

    def estimate(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
    ) -> Skeletons:
        """Return the joints of each body in `labels`, in the order of the bodies' numbers.

        Paper: each joint gets all its proposals. Here it gets the one with the largest confidence,
        as the other methods do; NaN if no pixel shows the part with enough probability.

        Args:
            depth: metres, 0 if the sensor measured nothing, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.

        Raises:
            InputError: an argument has another type, shape or unit.
        """
        images = check_images(depth, labels, camera)
        return estimate_bodies(images, self.joints, partial(self._estimate_body, images))

    def _estimate_body(self, images: ImageArguments, body: int) -> NDArray[np.float32] | None:
        """Return position and confidence of each joint, shape (J, 4); None without pixels."""
        pixels = classify_body(images, body, self._model.forest)
        if pixels is None:
            return None
        found = np.empty((len(self.joints), 4), np.float32)
        for j, settings in enumerate(self._model.proposals):
            cloud = part_cloud(pixels, 1 + int(self.joints[j]))
            proposal = surface_proposal(cloud, settings.bandwidth, settings.threshold)
            position = np.array(proposal[:3], np.float32)
            found[j, :3] = push_back(position, settings.depth_offset)
            found[j, 3] = proposal.confidence
        return found
