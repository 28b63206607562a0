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

"""Bodies in a depth image that comes without a mask."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.segmentation.background import Background
from lsc_pose_ros.segmentation.nearest_body import NearestBody
from lsc_pose_ros.settings.table import MASK, NEAREST, SEGMENTATIONS, SegmentationSettings


class Segmenter(Protocol):
    """Finds the bodies in depth images that come one after the other."""

    @property
    def ready(self) -> bool:
        """Whether it has learnt what it needs; before that it finds nobody."""

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Look at a depth image, metres, shape (H, W), of `stamp` nanoseconds, before `labels`."""

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return the number of the body that each pixel shows, NO_BODY for none, shape (H, W).

        Args:
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
            camera: the intrinsics.
        """


def make_segmenter(settings: SegmentationSettings) -> Segmenter | None:
    """Return the segmenter that `settings` ask for, None where masks come with the images.

    Raises:
        InputError: there is no such segmentation, or the range is empty.
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
    if settings.segmentation == NEAREST:
        return NearestBody(nearest, farthest)
    return Background(settings.background_seconds, settings.background_margin, nearest, farthest)


def segment(
    segmenter: Segmenter, stamp: int, depth: NDArray[np.float32], camera: Intrinsics
) -> NDArray[np.int32]:
    """Return the labels, shape (H, W), that `segmenter` gives to the next depth image.

    Args:
        segmenter: the one that has seen the images before.
        stamp: nanoseconds.
        depth: metres, 0 where the sensor saw nothing, shape (H, W).
        camera: the intrinsics.
    """
    segmenter.learn(stamp, depth)
    return segmenter.labels(depth, camera)
