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

"""A depth image with its label image."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class DepthImage(NamedTuple):
    """A depth image with the bodies that its pixels show.

    Attributes:
        depth: metres, 0 if the pixel shows nothing, shape (H, W), float32.
        labels: the body that a pixel shows, or NO_BODY, shape (H, W), int32.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
