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

"""Which joints of MSR-Action3D are on the right, and whether its images are mirrored.

Neither is published. But the subjects face the camera, and "were advised to use their right arm or
leg if an action is performed by a single arm or leg" (Li, Zhang, Liu 2010): so the hand that moves
more in those actions is the right one, and it is at image left if the image is not mirrored.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.datasets.msr_action3d_files import MsrSequence
from lsc_pose_ros.errors import InputError

ONE_ARM_ACTIONS = frozenset({1, 2, 3, 4, 5, 6, 7, 8, 9, 17, 18})
"""High and horizontal wave, hammer, catch, punch, throw, draw x, tick and circle, tennis."""

# The pairs in the order of the files; in each, the first one is of the same side.
_FIRST = np.array([0, 4, 7, 9, 11, 13, 15, 17])
_SECOND = np.array([1, 5, 8, 10, 12, 14, 16, 18])
_FIRST_HAND, _SECOND_HAND = 11, 12

# The hand that moves moves much more than the other one.
_CLEARLY = 1.5


class Sides(NamedTuple):
    """What is known of left and right.

    Attributes:
        second_is_right: whether the second joint of each pair is the right one.
        mirrored: whether the images are mirrored.
    """

    second_is_right: bool
    mirrored: bool

    def ordered(self, joints: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return joints, shape (F, 20, C), with the right one first in each pair."""
        if not self.second_is_right:
            return joints
        ordered = joints.copy()
        ordered[:, _FIRST], ordered[:, _SECOND] = joints[:, _SECOND], joints[:, _FIRST]
        return ordered


def find_sides(sequences: Sequence[MsrSequence]) -> Sides:
    """Return what the sequences tell of left and right.

    Raises:
        InputError: they do not tell it clearly.
    """
    votes = [_moving_hand(each.positions) for each in sequences if each.action in ONE_ARM_ACTIONS]
    first, second = votes.count(_FIRST_HAND), votes.count(_SECOND_HAND)
    if not max(first, second) > 2 * min(first, second):
        msg = (
            'left and right cannot be told: of the sequences with one arm, the first hand moves '
            f'more in {first} and the second in {second}; import more sequences of the actions '
            f'{", ".join(map(str, sorted(ONE_ARM_ACTIONS)))} together with these'
        )
        raise InputError(msg)
    second_is_right = second > first
    right = _SECOND if second_is_right else _FIRST
    left = _FIRST if second_is_right else _SECOND
    to_the_right = np.concatenate(
        [each.pixels[:, right[0], 0] - each.pixels[:, left[0], 0] for each in sequences]
    )
    return Sides(second_is_right, bool(np.nanmedian(to_the_right) > 0))


def _moving_hand(positions: NDArray[np.float64]) -> int:
    """Return the hand that moves clearly more, -1 if neither does."""
    hands = positions[:, [_FIRST_HAND, _SECOND_HAND]]
    first, second = np.nansum(np.linalg.norm(np.diff(hands, axis=0), axis=2), axis=0)
    if first > _CLEARLY * second:
        return _FIRST_HAND
    return _SECOND_HAND if second > _CLEARLY * first else -1
