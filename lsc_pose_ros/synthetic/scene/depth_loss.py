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

"""Loss of depth on dark hair and clothes, and on things that shine or are black."""

import math
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.pixel_codes import pixel_codes
from lsc_pose_ros.synthetic.sensors.correlated_noise import correlated_field

_DARK_FRACTION = 0.15  # of the people
_SHINY_FRACTION = 0.25  # of the scenes
_MOST_PATCHES = 4  # in such a scene
_PATCH = (0.02, 0.12)  # radii of patches, as a fraction of the image's width
_LOSS = (0.2, 0.95)  # fraction of the pixels that is lost
_SPACING = 0.03  # correlation length of the loss, as a fraction of the image's width
_LOGISTIC_SCALE = 1.702  # the logistic function then approximates the normal distribution

# Joints whose body parts are dark, and the largest fraction of their pixels that is lost.
_DARK_JOINTS = (
    (0.3, (('head',), 0.6)),  # hair, but not the face
    (0.3, (('pelvis', 'l_hip', 'r_hip', 'l_knee', 'r_knee', 'l_ankle', 'r_ankle'), 0.95)),
    (0.25, (('torso', 'neck', 'l_shoulder', 'r_shoulder', 'l_elbow', 'r_elbow'), 0.9)),
    (0.15, (('l_ankle', 'r_ankle', 'l_foot', 'r_foot'), 0.95)),
)


class DarkParts(NamedTuple):
    """Body parts on which the sensor loses depth.

    Attributes:
        body: the body's number.
        parts: the body parts.
        loss: fraction of their pixels that is lost.
    """

    body: int
    parts: tuple[int, ...]
    loss: float


class Patch(NamedTuple):
    """An ellipse in the image in which the sensor loses depth.

    Attributes:
        column: of its middle, as a fraction of the image's width.
        row: of its middle, as a fraction of the image's height.
        radii: along rows and columns, as a fraction of the image's width.
        loss: fraction of its pixels that is lost.
    """

    column: float
    row: float
    radii: tuple[float, float]
    loss: float


class DepthLoss(NamedTuple):
    """Where a scene's sensor loses depth."""

    dark: tuple[DarkParts, ...] = ()
    patches: tuple[Patch, ...] = ()


def sample_loss(people: int, stream: RandomStream) -> DepthLoss:
    """Sample where the sensor loses depth in a scene with people numbered from 1."""
    dark = []
    for body in range(1, people + 1):
        names, most = stream.choose(_DARK_JOINTS)
        loss = stream.between(_LOSS[0], most)
        if stream.bernoulli(_DARK_FRACTION):
            dark.append(DarkParts(body, tuple(1 + JOINT_NUMBERS[name] for name in names), loss))
    patches = []
    if stream.bernoulli(_SHINY_FRACTION):
        for _ in range(int(stream.between(1, _MOST_PATCHES + 1))):
            radii = stream.between(*_PATCH), stream.between(*_PATCH)
            position = stream.uniform(), stream.uniform()
            patches.append(Patch(*position, radii, stream.between(*_LOSS)))
    return DepthLoss(tuple(dark), tuple(patches))


def apply_loss(image: DepthImage, loss: DepthLoss, random: np.random.Generator) -> None:
    """Remove depth and labels where the sensor loses them, in irregular spots, in place.

    Args:
        image: its labels are pixel codes.
        loss: where depth is lost.
        random: the generator.
    """
    if not loss.dark and not loss.patches:
        return
    height, width = image.depth.shape
    field = correlated_field((height, width), max(_SPACING * width, 1.0), random)
    lost = np.zeros((height, width), bool)
    for body, parts, fraction in loss.dark:
        codes = pixel_codes(body, np.array(parts, np.int32))
        lost |= np.isin(image.labels, codes) & (field < _quantile(fraction))
    rows, columns = np.mgrid[:height, :width]
    for column, row, radii, fraction in loss.patches:
        across = (columns - column * width) / (radii[0] * width)
        down = (rows - row * height) / (radii[1] * width)
        lost |= (across**2 + down**2 < 1) & (field < _quantile(fraction))
    image.depth[lost] = 0.0
    image.labels[lost] = NO_BODY


def _quantile(probability: float) -> float:
    """Return the approximate quantile of the normal distribution."""
    return math.log(probability / (1.0 - probability)) / _LOGISTIC_SCALE
