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


"""Finds all people in a depth image alone, by the body parts that its pixels show."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.depth_grid import DepthGrid, depth_grid
from lsc_pose_ros.body_parts.part_network import CellParts, PartNetwork, classify
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.segmentation.cell_labels import labels_from_cells
from lsc_pose_ros.segmentation.person_cells import PersonCells, person_cells
from lsc_pose_ros.segmentation.person_instances import Bodies, find_bodies

STRIDE = 2
"""Each second cell of the depth grid is classified, along rows and columns."""

FARTHEST = 6.0
"""People at a larger depth are not found, because the network has not learnt them, metres."""

PERSON_THRESHOLD = 0.35
"""The least probability that a cell shows a person."""


class People:
    """Finds all people, with a network that classifies body parts.

    It gives each cell of a coarse grid the probabilities of 20 body parts and of "no person"
    (`body_parts/part_network.py`). It also says of each cell where the middle of its person is,
    which tells people apart (`person_instances.py`). Pixels are given to the cells
    (`cell_labels.py`). The most certain person is body 1.
    """

    ready = True
    warning = ''

    def __init__(self, network: PartNetwork, range_min: float, range_max: float) -> None:
        """Store network and range.

        Args:
            network: classifies body parts.
            range_min: metres; nearer pixels are no body.
            range_max: metres; farther pixels are no body.
        """
        self._network = network
        self._range = range_min, range_max

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Do nothing: images are independent."""

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return the body number of each pixel, NO_BODY for none, shape (H, W).

        Args:
            depth: metres, 0 if unknown, shape (H, W).
            camera: the intrinsics.
        """
        nearest, farthest = self._range
        grid = depth_grid(depth, camera)
        # The range only limits the pixels: a body that reaches out of it is judged as a whole.
        parts = classify(grid, self._network, STRIDE, FARTHEST)
        cells, bodies = find_people(grid, parts, camera)
        numbers = np.append(bodies.body, -1)[cells.number]
        labels = np.where(numbers >= 0, numbers + 1, NO_BODY).astype(np.int32)
        in_range = np.where((depth >= nearest) & (depth <= farthest), depth, np.float32(0))
        return labels_from_cells(in_range, labels, parts.depth, STRIDE * grid.step, grid.step // 2)


def find_people(
    grid: DepthGrid, parts: CellParts, camera: Intrinsics
) -> tuple[PersonCells, Bodies]:
    """Return the cells that show people, and the people.

    Args:
        grid: the depth grid.
        parts: what each STRIDE-th cell shows.
        camera: the intrinsics of the image.
    """
    spacing = STRIDE * grid.step
    in_cells = (
        float(camera.fx / spacing),
        float(camera.fy / spacing),
        float((camera.cx - grid.step // 2) / spacing),
        float((camera.cy - grid.step // 2) / spacing),
    )
    cells = person_cells(parts, in_cells, PERSON_THRESHOLD)
    return cells, find_bodies(cells)
