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

"""Gives labelled bodies the numbers that they have in the mask."""

import numpy as np

from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.segmentation.ground_truth_numbers import joints_on


def numbered_as_mask(skeletons: Skeletons, frame: Frame) -> Skeletons:
    """Return the bodies that the mask shows, with its numbers, sorted.

    Each body gets the number of the mask on which it has most joints. A body that has no joint on
    any mask, or shares a mask with a body that has more joints there, is left out.

    Args:
        skeletons: bodies with the numbers of another program.
        frame: the frame with its mask.
    """
    bodies = np.unique(frame.labels[frame.labels != NO_BODY])
    counts = np.array(
        [joints_on(frame.labels, bodies, each, frame.camera) for each in skeletons.positions]
    ).reshape(len(skeletons.bodies), len(bodies))
    rows: dict[int, int] = {}
    while counts.size and counts.max() > 0:
        row, rank = np.unravel_index(int(counts.argmax()), counts.shape)
        rows[int(bodies[rank])] = int(row)
        counts[row] = 0
        counts[:, rank] = 0
    numbers = sorted(rows)
    order = [rows[number] for number in numbers]
    visibility = skeletons.visibility
    return Skeletons(
        np.array(numbers, np.uint16),
        skeletons.joints,
        skeletons.positions[order],
        skeletons.confidence[order],
        None if visibility is None else visibility[order],
    )
