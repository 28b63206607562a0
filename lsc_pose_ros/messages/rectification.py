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

"""Decides whether an image is rectified: with P of its CameraInfo, or raw: with K and D.

A CameraInfo describes two images. K and D belong to the raw image; P belongs to the rectified
one, which has no distortion. The message does not say to which of them a depth image belongs.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lsc_pose_ros.settings.table import AUTO, RECTIFIED

# Larger differences between K and P are no rounding, relative to the focal length.
_SAME = 1e-4


class ImageSource(NamedTuple):
    """Where depth images come from, which decides how their camera infos are read.

    Attributes:
        topic: the topic of the depth images.
        rectified: the setting `rectified`.
    """

    topic: str = ''
    rectified: str = AUTO


ANY_SOURCE = ImageSource()
"""Images of an unknown topic; the decision is left to the camera info."""


class Rectification(NamedTuple):
    """Whether the images are rectified.

    Attributes:
        rectified: True if P holds for them.
        reason: why, for the log.
    """

    rectified: bool
    reason: str


def find_rectification(
    source: ImageSource, k: ArrayLike, p: ArrayLike, *, distorted: bool
) -> Rectification:
    """Return whether the images of `source` are rectified.

    Args:
        source: the images' topic and the user's choice.
        k: the matrix K, shape (9,).
        p: the matrix P, shape (12,).
        distorted: whether D and its model describe a distortion.
    """
    if source.rectified != AUTO:
        return Rectification(source.rectified == RECTIFIED, f'rectified is {source.rectified}')
    differs = _differ(k, p)
    if not (distorted or differs):
        return Rectification(False, 'D is zero, and P is K')  # noqa: FBT003
    named = _named_as(source.topic)
    if named is not None:
        return Rectification(named, f'the topic is named {source.topic}')
    if distorted:
        return Rectification(False, 'D is not zero')  # noqa: FBT003
    return Rectification(True, 'D is zero, and P differs from K')  # noqa: FBT003


def _named_as(topic: str) -> bool | None:
    """Return whether a topic is named as rectified or raw images are, None if it says neither.

    The last part of the name that says it counts: /raw_cameras/1/image_rect is rectified. The
    drivers of stereo cameras name their rectified images image_rect_raw.
    """
    for part in reversed(topic.lower().split('/')):
        words = part.split('_')
        if 'rect' in words or 'rectified' in words:
            return True
        if 'raw' in words:
            return False
    return None


def has_camera(p: ArrayLike) -> bool:
    """Return whether P holds focal lengths; uncalibrated drivers leave it zero."""
    fx, fy = np.asarray(p, np.float64)[[0, 5]]
    return bool(fx > 0 and fy > 0)


def _differ(k: ArrayLike, p: ArrayLike) -> bool:
    raw = np.asarray(k, np.float64)[[0, 4, 2, 5]]
    if not (has_camera(p) and (raw[:2] > 0).all() and np.isfinite(raw).all()):
        return False
    rectified = np.asarray(p, np.float64)[[0, 5, 2, 6]]
    return bool((np.abs(raw - rectified) > _SAME * abs(raw[0])).any())
