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


"""A small convolutional network that tells which part of a person each cell of a grid shows.

The classes are those of J. Shotton et al., "Real-time human pose recognition in parts from single
depth images", CVPR 2011, and "no person". Their forest compares depths at pairs of points, and
takes many things of the size of a limb for one; a network sees what is around a cell as a whole.
It is a U-Net (O. Ronneberger et al., "U-Net: convolutional networks for biomedical image
segmentation", MICCAI 2015) of four levels, with residual sums (K. He et al., "Deep residual
learning for image recognition", CVPR 2016).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.convolution import (
    add,
    add_doubled,
    convolve,
    convolve_halving,
    mix,
    rectify,
    with_border,
)
from lsc_pose_ros.body_parts.depth_grid import DepthGrid
from lsc_pose_ros.numerics.fast_math import exp_neg
from lsc_pose_ros.numerics.jit import kernel

INPUTS = 5
"""The number of planes that the network sees."""

OUTPUTS = CLASSES + 3
"""The number of planes that it returns: scores of the classes, and the way to the middle."""

CELL_WIDTH = np.float32(0.035)
"""The first plane is 0 where a cell is this wide, metres."""

LARGEST_LOGARITHM = np.float32(3.0)
"""The first plane is cut to this, and to its negative."""

FARTHEST_MIDDLE = np.float32(2.0)
"""No cell is farther from the middle of its person, along each axis, metres."""

MIDDLE_DEPTH = np.float32(3.0)
"""The last plane is 0 at this depth, metres; it is cut at 0 and at three times this depth."""


class Layer(NamedTuple):
    """A convolution.

    Attributes:
        weights: shape (O, C, 9) for 3 x 3 cells, (O, C) for one cell; float32.
        bias: shape (O,), float32.
    """

    weights: NDArray[np.float32]
    bias: NDArray[np.float32]


class PartNetwork(NamedTuple):
    """The layers of the network.

    Attributes:
        down_0: the 3 x 3 convolution of the inputs.
        halve_1: halves rows and columns; halve_2 and halve_3, too.
        down_1: a residual on the first coarse level; down_2 on the second, down_3a and down_3b on
            the third.
        up_2: mixes the planes of the third level, which are added to the second one; up_1 and
            up_0 lead to the levels below.
        refine_2: a residual on the second level; refine_1 on the first.
        refine_0: the last 3 x 3 convolution, on the cells of the grid.
        scores: mixes its planes to the logarithms of the probabilities, but for their sum, and to
            the way to the middle of the person.
    """

    down_0: Layer
    halve_1: Layer
    down_1: Layer
    halve_2: Layer
    down_2: Layer
    halve_3: Layer
    down_3a: Layer
    down_3b: Layer
    up_2: Layer
    refine_2: Layer
    up_1: Layer
    refine_1: Layer
    up_0: Layer
    refine_0: Layer
    scores: Layer


class CellParts(NamedTuple):
    """What the cells of a grid show.

    Attributes:
        depth: metres, 0 if unknown, shape (h, w).
        person: the probability that the cell shows a person, shape (h, w); 0 at a cell that is
            not classified.
        to_middle: from each cell to the middle of what is visible of its person, across and down
            the image at the depth of the cell, and away from the camera, metres, shape (h, w, 3).
    """

    depth: NDArray[np.float32]
    person: NDArray[np.float32]
    to_middle: NDArray[np.float32]


def classify(grid: DepthGrid, network: PartNetwork, stride: int, farthest: float) -> CellParts:
    """Return what every `stride`-th cell of a grid shows.

    Args:
        grid: the depth grid.
        network: the network.
        stride: how many cells apart the classified ones are, along rows and columns.
        farthest: cells at a larger depth are not classified, metres.
    """
    depth = np.ascontiguousarray(grid.depth[::stride, ::stride])
    fx, fy = grid.focal_lengths
    scores = score_cells(input_planes(depth, (fx / stride, fy / stride)), network)
    return CellParts(
        depth, person_probabilities(scores, depth, farthest), middles_of(scores, depth.shape)
    )


@kernel
def input_planes(
    depth: NDArray[np.float32], focal_lengths: tuple[float, float]
) -> NDArray[np.float32]:
    """Return what the network sees of a depth image, shape (INPUTS, h, w).

    They are the logarithm of the width of a cell z / f, whether the depth is known, the slope of
    the surface along columns and rows s / (1 + |s|) with s = dz / (2 z / f), and the depth.
    Widths and slopes do not depend on the camera. All are 0 where the depth is unknown.

    Args:
        depth: metres, 0 if unknown, shape (h, w).
        focal_lengths: fx and fy in cells.
    """
    height, width = depth.shape
    focal_length = np.float32(np.sqrt(focal_lengths[0] * focal_lengths[1]))
    planes = np.zeros((INPUTS, height, width), np.float32)
    one = np.float32(1)
    for i in range(height):
        for j in range(width):
            z = depth[i, j]
            if not z > 0:
                continue
            size = np.log(z / (focal_length * CELL_WIDTH))
            planes[0, i, j] = min(max(size, -LARGEST_LOGARITHM), LARGEST_LOGARITHM)
            planes[1, i, j] = one
            planes[4, i, j] = min(z / MIDDLE_DEPTH - one, np.float32(2))
            if 0 < j < width - 1 and depth[i, j - 1] > 0 and depth[i, j + 1] > 0:
                planes[2, i, j] = _bounded(depth[i, j - 1], z, depth[i, j + 1], focal_length)
            if 0 < i < height - 1 and depth[i - 1, j] > 0 and depth[i + 1, j] > 0:
                planes[3, i, j] = _bounded(depth[i - 1, j], z, depth[i + 1, j], focal_length)
    return planes


@kernel
def _bounded(
    before: np.float32, z: np.float32, after: np.float32, focal_length: np.float32
) -> np.float32:
    slope = np.float32(0.5) * (after - before) * focal_length / z
    bounded: np.float32 = slope / (np.float32(1) + abs(slope))
    return bounded


@kernel
def score_cells(planes: NDArray[np.float32], network: PartNetwork) -> NDArray[np.float32]:
    """Return the outputs of the network at each cell, with border, flat, shape (OUTPUTS, N).

    Args:
        planes: as `input_planes` returns them, shape (INPUTS, h, w).
        network: the network.
    """
    shape_0 = planes.shape[1], planes.shape[2]
    shape_1 = (shape_0[0] + 1) // 2, (shape_0[1] + 1) // 2
    shape_2 = (shape_1[0] + 1) // 2, (shape_1[1] + 1) // 2
    shape_3 = (shape_2[0] + 1) // 2, (shape_2[1] + 1) // 2
    level_0 = convolve(with_border(planes), shape_0, network.down_0.weights, network.down_0.bias)
    rectify(level_0, shape_0)
    level_1 = _halved(level_0, shape_0, network.halve_1)
    _add_residual(level_1, shape_1, network.down_1)
    level_2 = _halved(level_1, shape_1, network.halve_2)
    _add_residual(level_2, shape_2, network.down_2)
    level_3 = _halved(level_2, shape_2, network.halve_3)
    _add_residual(level_3, shape_3, network.down_3a)
    _add_residual(level_3, shape_3, network.down_3b)
    _add_from_above(level_2, shape_2, level_3, network.up_2)
    _add_residual(level_2, shape_2, network.refine_2)
    _add_from_above(level_1, shape_1, level_2, network.up_1)
    _add_residual(level_1, shape_1, network.refine_1)
    _add_from_above(level_0, shape_0, level_1, network.up_0)
    refined = convolve(level_0, shape_0, network.refine_0.weights, network.refine_0.bias)
    rectify(refined, shape_0)
    return mix(refined, network.scores.weights, network.scores.bias)


@kernel
def _halved(
    planes: NDArray[np.float32], shape: tuple[int, int], layer: Layer
) -> NDArray[np.float32]:
    halved = convolve_halving(planes, shape, layer.weights, layer.bias)
    rectify(halved, ((shape[0] + 1) // 2, (shape[1] + 1) // 2))
    return halved


@kernel
def _add_residual(planes: NDArray[np.float32], shape: tuple[int, int], layer: Layer) -> None:
    add(planes, convolve(planes, shape, layer.weights, layer.bias))
    rectify(planes, shape)


@kernel
def _add_from_above(
    planes: NDArray[np.float32],
    shape: tuple[int, int],
    coarse: NDArray[np.float32],
    layer: Layer,
) -> None:
    add_doubled(planes, shape, mix(coarse, layer.weights, layer.bias))
    rectify(planes, shape)


@kernel
def person_probabilities(
    scores: NDArray[np.float32], depth: NDArray[np.float32], farthest: float
) -> NDArray[np.float32]:
    """Return the probability of a person at each cell, shape (h, w).

    It is 1 - exp(s_n) / sum_k exp(s_k): class n is NOT_A_PERSON, k runs over all classes.

    Args:
        scores: with border, flat, shape (OUTPUTS, (h + 2) (w + 2)).
        depth: metres, 0 if unknown, shape (h, w).
        farthest: cells at a larger depth have probability 0, metres.
    """
    height, width = depth.shape
    person = np.zeros((height, width), np.float32)
    largest, total = np.empty(width, np.float32), np.empty(width, np.float32)
    for i in range(height):
        first = (i + 1) * (width + 2) + 1
        row = scores[:CLASSES, first : first + width]
        largest[:] = row[0]
        for c in range(1, CLASSES):
            for j in range(width):
                largest[j] = max(largest[j], row[c, j])
        total[:] = 0
        for c in range(CLASSES):
            for j in range(width):
                total[j] += exp_neg(largest[j] - row[c, j])
        for j in range(width):
            nobody = exp_neg(largest[j] - row[NOT_A_PERSON, j])
            if 0 < depth[i, j] <= farthest:
                person[i, j] = np.float32(1) - nobody / total[j]
    return person


@kernel
def middles_of(scores: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return the way from each cell to the middle of its person, metres, shape (h, w, 3).

    Args:
        scores: with border, flat, shape (OUTPUTS, (h + 2) (w + 2)).
        shape: h and w.
    """
    height, width = shape
    to_middle = np.empty((height, width, 3), np.float32)
    for i in range(height):
        for j in range(width):
            for k in range(3):
                value = scores[CLASSES + k, (i + 1) * (width + 2) + j + 1]
                # Written so that NaN becomes a number. No vote so far away counts.
                inside = -FARTHEST_MIDDLE < value < FARTHEST_MIDDLE
                to_middle[i, j, k] = value if inside else FARTHEST_MIDDLE
    return to_middle
