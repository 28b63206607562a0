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

"""Finds the bodies in depth images without masks."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.part_network_file import load_part_network
from lsc_pose_ros.segmentation.background import Background
from lsc_pose_ros.segmentation.nearest_body import NearestBody
from lsc_pose_ros.segmentation.people import People
from lsc_pose_ros.settings.table import (
    AUTO,
    MASK,
    NEAREST,
    PEOPLE,
    SEGMENTATIONS,
    SegmentationSettings,
)


class Segmenter(Protocol):
    """Finds the bodies in a sequence of depth images."""

    @property
    def ready(self) -> bool:
        """Whether learning has finished; before that no body is found."""

    @property
    def warning(self) -> str:
        """A sentence on what is suspicious; '' for nothing."""

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Learn from a depth image, before `labels` is called with it.

        Args:
            stamp: nanoseconds.
            depth: metres, 0 if unknown, shape (H, W).
        """

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return the body number of each pixel, NO_BODY for none, shape (H, W).

        Args:
            depth: metres, 0 if unknown, shape (H, W).
            camera: the intrinsics.
        """


def make_segmenter(settings: SegmentationSettings) -> Segmenter | None:
    """Return the segmenter for images without a mask, or None if `settings` ask for masks.

    Raises:
        InputError: the segmentation is unknown, or the range is empty.
    """
    if settings.segmentation not in SEGMENTATIONS:
        msg = (
            f'segmentation: {settings.segmentation!r} is not known; '
            f'it must be {" or ".join(SEGMENTATIONS)}'
        )
        raise InputError(msg)
    if settings.segmentation == MASK:
        return None
    nearest, farthest = settings.range_min, settings.range_max
    if not 0 <= nearest < farthest:
        msg = (
            f'range_min is {nearest:g} m and range_max {farthest:g} m; range_min must be '
            'the smaller'
        )
        raise InputError(msg)
    if settings.segmentation in (AUTO, PEOPLE):
        return People(load_part_network().network, nearest, farthest)
    if settings.segmentation == NEAREST:
        return NearestBody(nearest, farthest)
    return Background(settings.background_seconds, settings.background_margin, nearest, farthest)


def segment(
    segmenter: Segmenter, stamp: int, depth: NDArray[np.float32], camera: Intrinsics
) -> NDArray[np.int32]:
    """Return the body number of each pixel of the next depth image, shape (H, W).

    Args:
        segmenter: the segmenter of the images before.
        stamp: nanoseconds.
        depth: metres, 0 if unknown, shape (H, W).
        camera: the intrinsics.
    """
    segmenter.learn(stamp, depth)
    return segmenter.labels(depth, camera)
