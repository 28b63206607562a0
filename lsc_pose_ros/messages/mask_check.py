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

"""Finds masks whose background seems to be another value than `mask_background`."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError

# A body does not cover as much of the border and of the whole image; the background does.
_LEAST_OF_BORDER = 0.8
_LEAST_OF_IMAGE = 0.5

# So many masks are checked. A wrong setting shows in each of them.
_CHECKED = 30


class MaskCheck:
    """Checks the first masks of a sequence.

    Attributes:
        warning: a sentence that asks about the background, '' while nothing is wrong.
    """

    def __init__(self, topic: str, mask_background: int) -> None:
        """Start without masks.

        Args:
            topic: the topic of the masks.
            mask_background: the setting.
        """
        self.warning = ''
        self._topic = topic
        self._background = mask_background
        self._left = _CHECKED

    def add(self, labels: NDArray[np.int32]) -> None:
        """Check the next mask.

        Args:
            labels: its body numbers, NO_BODY for none, shape (H, W).

        Raises:
            InputError: the mask has no background, and 0 is a body, which is the background of
                most masks.
        """
        if labels.size == 0:
            return
        if labels[0, 0] != NO_BODY and labels.min() == 0:
            msg = (
                f'{self._topic}: no pixel of the mask has the value {self._background} of '
                'mask_background, but 0 is a body; is mask_background right?'
            )
            raise InputError(msg)
        if not self._left:
            return
        self._left -= 1
        value = background_like(labels)
        if value is None:
            return
        self._left = 0
        percent = 100 * np.count_nonzero(labels == value) / labels.size
        self.warning = (
            f'{self._topic}: the value {value} covers {percent:.0f} % of the mask and is taken '
            f'for a body, because mask_background is {self._background}; is mask_background right?'
        )


def background_like(labels: NDArray[np.int32]) -> int | None:
    """Return the body number that covers the mask as a background does, None for none.

    Args:
        labels: the body number of each pixel, NO_BODY for none, shape (H, W).
    """
    border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    value = int(np.median(border))
    if value == NO_BODY or np.count_nonzero(border == value) < _LEAST_OF_BORDER * border.size:
        return None
    covered = np.count_nonzero(labels == value)
    return value if covered >= _LEAST_OF_IMAGE * labels.size else None
