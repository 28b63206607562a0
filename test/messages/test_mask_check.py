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

"""The question about masks whose background seems to be another value."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.mask_check import MaskCheck, background_like


def mask(background: int, body: int, rows: slice, columns: slice) -> np.ndarray:
    labels = np.full((48, 64), background, np.int32)
    labels[rows, columns] = body
    return labels


WALKING = slice(5, 48), slice(20, 36)


def test_background_that_is_taken_for_a_body_is_asked_about() -> None:
    check = MaskCheck('/body_index_map', 0)
    check.add(mask(255, 1, *WALKING))
    covered = round(100 * (1 - 43 * 16 / (48 * 64)))
    assert check.warning == (
        f'/body_index_map: the value 255 covers {covered} % of the mask and is taken for a body, '
        'because mask_background is 0; is mask_background right?'
    )


@pytest.mark.parametrize(
    'labels',
    [
        mask(NO_BODY, 1, *WALKING),
        mask(NO_BODY, 1, slice(0, 48), slice(3, 64)),  # close to the camera
        mask(NO_BODY, 1, slice(3, 48), slice(0, 64)),
        np.full((48, 64), NO_BODY, np.int32),
        np.zeros((0, 0), np.int32),
        mask(7, NO_BODY, slice(1, 47), slice(1, 63)),  # a frame around the image
    ],
)
def test_other_masks_are_not(labels: np.ndarray) -> None:
    check = MaskCheck('/mask', 0)
    check.add(labels)
    assert not check.warning


def test_nobody_in_view_is_no_excuse() -> None:
    assert background_like(np.full((4, 5), 255, np.int32)) == 255


def test_only_the_first_masks_are_checked() -> None:
    check = MaskCheck('/mask', 0)
    for _ in range(30):
        check.add(mask(NO_BODY, 1, *WALKING))
    check.add(mask(255, 1, *WALKING))
    assert not check.warning


def test_mask_without_background_whose_body_is_0_is_refused() -> None:
    check = MaskCheck('/mask', 255)
    with pytest.raises(InputError, match='no pixel of the mask has the value 255'):
        check.add(mask(0, 1, *WALKING))
    check.add(mask(NO_BODY, 0, *WALKING))  # the first body of an Azure Kinect
    check.add(mask(3, 2, *WALKING))
