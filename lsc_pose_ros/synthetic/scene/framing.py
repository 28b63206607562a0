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

"""What a camera in a furnished room shows of people: all, or less; and margins without depth."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.people import SyntheticPerson
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.placement import CameraConstraints, PersonExtent

_CROPPED_FRACTION = 0.5
_CLOSE_FRACTION = 0.6  # of the cropped scenes, with people at the near end of the distances
_CLOSE_RANGE = 0.35  # that end, as a fraction of the range
_BEARING_DIFFERENCE = (1.0, 9.0)  # of two people, degrees
_PEOPLE_GAP = 0.01  # metres
_TOGETHER_FRACTION = 0.4  # of the scenes, with people close to each other
_MARGIN_FRACTION = 1 / 3
_WIDEST_MARGIN = 0.08  # as a fraction of the image's width or height

# The joint that is in view if people are cut off.
_KEPT_JOINTS = ((0.35, 'neck'), (0.15, 'head'), (0.3, 'torso'), (0.1, 'pelvis'), (0.1, 'l_knee'))


class Margins(NamedTuple):
    """Margins of an image without depth, pixels."""

    left: int = 0
    right: int = 0
    top: int = 0
    bottom: int = 0


class Framing(NamedTuple):
    """What the camera shows of the people.

    Attributes:
        constraints: of camera and people.
        kept: the joint of each person that is in view if people are cut off.
        margins: where the sensor measures nothing.
    """

    constraints: CameraConstraints
    kept: str = 'torso'
    margins: Margins = Margins()

    def relaxed(self, constraints: CameraConstraints) -> 'Framing':
        """Return a framing within `constraints` that is easy to satisfy: people can be cut off."""
        easier = constraints._replace(cropped=True, bearing_difference=0.0, people_gap=_PEOPLE_GAP)
        return self._replace(constraints=easier)

    def extent(self, person: SyntheticPerson) -> PersonExtent:
        """Return the extent of a person with the joint that is in view."""
        return person.extent._replace(trunk=person.joints[:, JOINT_NUMBERS[self.kept]])


def sample_framing(constraints: CameraConstraints, stream: RandomStream) -> Framing:
    """Sample what the camera shows of the people; half of the scenes can cut them off."""
    cropped = stream.bernoulli(_CROPPED_FRACTION) or constraints.cropped
    kept, close = stream.choose(_KEPT_JOINTS), stream.bernoulli(_CLOSE_FRACTION)
    near, far = constraints.distance
    if cropped and close:
        far = near + _CLOSE_RANGE * (far - near)
    sides = [_WIDEST_MARGIN * stream.uniform() * stream.bernoulli(0.5) for _ in range(4)]
    if not stream.bernoulli(_MARGIN_FRACTION):
        sides = [0.0] * 4
    width, height = constraints.width, constraints.height
    return Framing(
        constraints._replace(
            distance=(near, far),
            cropped=cropped,
            bearing_difference=float(np.radians(stream.between(*_BEARING_DIFFERENCE))),
            people_gap=_PEOPLE_GAP,
            together=stream.bernoulli(_TOGETHER_FRACTION),
        ),
        kept,
        Margins(
            *(round(a * b) for a, b in zip(sides, (width, width, height, height), strict=True))
        ),
    )


def clear_margins(image: DepthImage, margins: Margins) -> None:
    """Remove depth and labels of an image in its margins."""
    height, width = image.depth.shape
    for rows, columns in (
        (slice(None), slice(0, margins.left)),
        (slice(None), slice(width - margins.right, width)),
        (slice(0, margins.top), slice(None)),
        (slice(height - margins.bottom, height), slice(None)),
    ):
        image.depth[rows, columns] = 0.0
        image.labels[rows, columns] = NO_BODY
