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

"""One body of one frame with all results of the method: the input of the stage figures."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.crop import Box, box_around

_ASPECT = 0.7  # width / height: that of a person upright, narrower than in a contact sheet


class ShownBody(NamedTuple):
    """One body with the results of the stages of the method.

    Attributes:
        label: the frame's name, for example 'frame 12'.
        frame: the images, the camera and the ground truth if there is one.
        settings: the parameters of silhouette and descriptors.
        result: the results of all stages, or without a model of those up to the descriptors.
        model: the model that estimated the joints; None without a model.
        box: the part of the image that is drawn.
    """

    label: str
    frame: Frame
    settings: Settings
    result: BodyEstimate
    model: Model | None
    box: Box

    @property
    def number(self) -> int:
        """The body's number in the mask."""
        return self.result.number

    def ground_truth(self, joints: NDArray[np.uint16]) -> NDArray[np.float32]:
        """Return the true positions of `joints`, metres, NaN if not labelled, shape (J, 3)."""
        ground_truth = self.frame.ground_truth
        if ground_truth is not None and self.number in ground_truth.bodies:
            row = int(np.flatnonzero(ground_truth.bodies == self.number)[0])
            positions: NDArray[np.float32] = select_joints(ground_truth, joints)[row]
            return positions
        return np.full((len(joints), 3), np.nan, np.float32)


def show_body(
    label: str, frame: Frame, body: int | None = None, model: Model | None = None
) -> ShownBody:
    """Run the stages of the method on one body of `frame`.

    Args:
        label: the frame's name in the figures.
        frame: the images and the camera.
        body: the body's number; None for the one that covers the most pixels.
        model: None to stop at the descriptors, which need no model.

    Raises:
        InputError: there is no such body, or too little of it is visible.
    """
    number = _largest_body(frame, label) if body is None else body
    if not (frame.labels == number).any():
        present = ', '.join(map(str, np.unique(frame.labels[frame.labels >= 0]))) or 'none'
        msg = f'{label}: the mask has no body {number}; the bodies in it: {present}'
        raise InputError(msg)
    settings = model.settings if model is not None else Settings()
    if model is None:
        result = describe_body(frame.depth, frame.labels, frame.camera, number, settings)
    else:
        result = Estimator(model).estimate_body(frame.depth, frame.labels, frame.camera, number)
    if result is None:
        msg = f'{label}: too little of body {number} is visible to draw its stages'
        raise InputError(msg)
    return ShownBody(label, frame, settings, result, model, box_around(frame, number, _ASPECT))


def _largest_body(frame: Frame, label: str) -> int:
    pixels = frame.labels[frame.labels >= 0]
    if len(pixels) == 0:
        msg = f'{label}: the mask shows nobody; choose another frame'
        raise InputError(msg)
    return int(np.bincount(pixels).argmax())
