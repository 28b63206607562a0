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

"""Compiles the kernels of the estimation before the first frame, or loads them from disk."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import PLUMB_BOB, Intrinsics, Lens
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.codecs.rvl import decode_rvl
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.segmentation.segmenter import Segmenter, segment

_DISTANCE = np.float32(2.0)

# With a lens, so that the kernels for distortion are compiled, too. The models share them.
_LENS = Lens(PLUMB_BOB, (0.001,))
_CAMERA = Intrinsics(285.0, 285.0, 160.0, 120.0, _LENS)

# A figure in an image of 320 x 240: head, trunk with arms spread, legs. Top, bottom, left, right.
_FIGURE = ((20, 50, 148, 172), (50, 130, 135, 185), (58, 70, 70, 250), (130, 220, 137, 155),
           (130, 220, 165, 183))  # fmt: skip

# The row of the counter's upper edge, and by how many rows and columns the mask is displaced.
_COUNTER_TOP = 180
_MASK_SHIFT = 5

# RVL for four pixels that are 0.
_EMPTY_RVL = bytes((0, 0, 0, 0x40))


def warm_up(estimator: Estimator) -> Skeletons:
    """Estimate an artificial figure, so that all kernels for frames are compiled.

    The kernels that decode compressed depth images are compiled, too.

    Returns:
        The estimate of the figure, body 1.
    """
    figure = _draw_figure()
    labels = np.where(figure, np.int32(1), np.int32(NO_BODY))
    decode_rvl(_EMPTY_RVL, 4)
    # Before a wall, behind a counter and with a sloppy mask.
    scene = np.where(figure, _DISTANCE, 2 * _DISTANCE)
    scene[_COUNTER_TOP:] = 0.5 * _DISTANCE
    estimator.estimate(scene, np.roll(labels, _MASK_SHIFT, axis=(0, 1)), _CAMERA)
    return estimator.estimate(np.where(figure, _DISTANCE, np.float32(0)), labels, _CAMERA)


def warm_up_segmenter(segmenter: Segmenter, seconds: float) -> None:
    """Segment a wall, and then a figure in front of it.

    Args:
        segmenter: a new segmenter; it cannot be used for other images afterwards.
        seconds: duration for which it learns the background.
    """
    wall = np.full((240, 320), 2 * _DISTANCE, np.float32)
    duration = round(seconds * 1e9)
    segment(segmenter, 0, wall, _CAMERA)
    segment(segmenter, duration, wall, _CAMERA)
    figure = np.where(_draw_figure(), _DISTANCE, wall)
    segment(segmenter, 2 * duration, figure, _CAMERA)


def _draw_figure() -> NDArray[np.bool_]:
    figure = np.zeros((240, 320), np.bool_)
    for top, bottom, left, right in _FIGURE:
        figure[top:bottom, left:right] = True
    return figure
