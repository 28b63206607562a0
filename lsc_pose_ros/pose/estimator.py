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

"""Estimates the joints of each body in a depth image with one model."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.stages import Observer, Stage, method_stages, run_stages


class Estimator:
    """Estimates joints with one model.

    Attributes:
        model: a trained model.
        graph: whether the pictorial structure joins the modes.
        stages: the stages of the method in their order.
    """

    def __init__(
        self, model: Model, *, graph: bool = True, stages: Sequence[Stage] | None = None
    ) -> None:
        """Prepare the stages.

        Args:
            model: a trained model.
            graph: whether the pictorial structure joins the modes (eq. 16, 17); without it each
                joint is the highest mode of its own density (eq. 14).
            stages: stages to run instead of those of the method, with the same results.
        """
        self.model = model
        self.graph = graph
        self.stages = tuple(stages or method_stages(model, graph=graph))

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""
        return self.model.joints

    def estimate(
        self,
        depth: NDArray[np.float32],
        labels: NDArray[np.int32],
        camera: Intrinsics,
        observer: Observer | None = None,
    ) -> Skeletons:
        """Return the joints of each body in `labels`, in the order of the bodies' numbers.

        A body of which too little is visible has NaN joints with confidence 0.

        Args:
            depth: metres, 0 if the sensor measured nothing, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.
            observer: called when a stage has ended, for each body.
        """
        bodies = bodies_in(labels)
        count = len(self.model.joints)
        positions = np.full((len(bodies), count, 3), np.nan, np.float32)
        confidence = np.zeros((len(bodies), count), np.float32)
        for row, number in enumerate(bodies):
            body = self.estimate_body(depth, labels, camera, int(number), observer)
            if body is not None:
                positions[row] = body.joints
                confidence[row] = body.confidence
        return Skeletons(bodies, self.model.joints, positions, confidence)

    def estimate_body(
        self,
        depth: NDArray[np.float32],
        labels: NDArray[np.int32],
        camera: Intrinsics,
        number: int,
        observer: Observer | None = None,
    ) -> BodyEstimate | None:
        """Return the results of all stages for one body, or None if too little of it is visible.

        Args:
            depth: as `estimate`.
            labels: as `estimate`.
            camera: as `estimate`.
            number: the body's number in `labels`.
            observer: as `estimate`.
        """
        body = BodyEstimate.in_image(depth, labels, camera, number)
        return body if run_stages(self.stages, body, observer) else None


def bodies_in(labels: NDArray[np.int32]) -> NDArray[np.uint16]:
    """Return the numbers of the bodies in a mask, sorted, shape (B,)."""
    foreground = labels[labels >= 0]
    return np.flatnonzero(np.bincount(foreground)).astype(np.uint16)
