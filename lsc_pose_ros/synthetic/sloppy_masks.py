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

"""Sloppy masks: exact masks that are grown, shrunk, shifted and holed, as segmenters draw them."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY, Frame

ERROR = (1 / 64, 3 / 64)
"""Range of the error of an outline, relative to the width of the image: 5 to 15 of 320 pixels."""

MOST_HOLES = 3
HOLE_RADIUS = (1 / 80, 1 / 32)
"""The largest number of holes in a body, and the range of their radii, as ERROR."""


class MaskError(NamedTuple):
    """How the mask of a body is wrong.

    Attributes:
        growth: by how many pixels it is larger; smaller if negative.
        shift: by how many rows and columns it is displaced.
        holes: row, column and radius of each hole, pixels; rows and columns of the exact mask.
    """

    growth: int = 0
    shift: tuple[int, int] = (0, 0)
    holes: tuple[tuple[int, int, int], ...] = ()


def with_sloppy_masks(frames: Iterable[Frame], seed: int) -> Iterator[Frame]:
    """Yield `frames` with a random error in the mask of each body.

    Args:
        frames: frames with exact masks.
        seed: the seed of the errors; the error of a frame depends on its index, too.
    """
    for index, frame in enumerate(frames):
        random = np.random.default_rng((seed, index))
        yield frame._replace(labels=sloppy_labels(frame.labels, random))


def sloppy_labels(labels: NDArray[np.int32], random: np.random.Generator) -> NDArray[np.int32]:
    """Return labels with a random error in the mask of each body, shape (H, W).

    Args:
        labels: exact body numbers, NO_BODY for none, shape (H, W).
        random: the source of the errors.
    """
    sloppy = np.full_like(labels, NO_BODY)
    for body in np.unique(labels[labels != NO_BODY]):
        mask = labels == body
        wrong = distort(mask, sample_error(mask, random))
        sloppy[wrong & (sloppy == NO_BODY)] = body
    return sloppy


def sample_error(mask: NDArray[np.bool_], random: np.random.Generator) -> MaskError:
    """Return a random error for the exact mask of a body: growth, loss or shift, and holes.

    Args:
        mask: the body's pixels, at least one, shape (H, W).
        random: the source of the error.
    """
    width = mask.shape[1]
    pixels = round(width * random.uniform(*ERROR))
    kind = random.integers(3)
    angle = random.uniform(0, 2 * np.pi)
    shift = round(pixels * np.sin(angle)), round(pixels * np.cos(angle))
    candidates = np.argwhere(mask)
    centres = candidates[random.integers(len(candidates), size=random.integers(MOST_HOLES + 1))]
    radii = np.rint(width * random.uniform(*HOLE_RADIUS, len(centres)))
    return MaskError(
        # A limb that is narrower than twice the loss disappears.
        (pixels, -max(1, pixels // 3), 0)[kind],
        shift if kind == 2 else (0, 0),
        tuple(
            (int(r), int(c), int(radius)) for (r, c), radius in zip(centres, radii, strict=True)
        ),
    )


def distort(mask: NDArray[np.bool_], error: MaskError) -> NDArray[np.bool_]:
    """Return the mask of a body with an error, shape (H, W).

    Args:
        mask: the body's pixels, shape (H, W).
        error: the error.
    """
    rows, columns = np.indices(mask.shape)
    kept = mask.copy()
    for row, column, radius in error.holes:
        kept &= (rows - row) ** 2 + (columns - column) ** 2 > radius**2
    grown = grow(kept, error.growth) if error.growth >= 0 else ~grow(~kept, -error.growth)
    return shifted(grown, error.shift)


def grow(mask: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
    """Return `mask` grown by some pixels, with an octagon as the structuring element."""
    grown = mask
    for step in range(pixels):
        before = np.pad(grown, 1)
        grown = before[1:-1, 1:-1] | before[:-2, 1:-1] | before[2:, 1:-1]
        if step % 2:  # a square, otherwise a diamond
            sides = before[:, :-2] | before[:, 2:]
            grown = grown | sides[:-2] | sides[1:-1] | sides[2:]
        else:
            grown = grown | before[1:-1, :-2] | before[1:-1, 2:]
    return grown


def shifted(mask: NDArray[np.bool_], shift: tuple[int, int]) -> NDArray[np.bool_]:
    """Return `mask` displaced by some rows and columns; what leaves the image is lost."""
    height, width = mask.shape
    down, right = np.clip(shift, (-height, -width), (height, width)).tolist()
    moved = np.zeros_like(mask)
    moved[max(down, 0) : height + min(down, 0), max(right, 0) : width + min(right, 0)] = mask[
        max(-down, 0) : height - max(down, 0), max(-right, 0) : width - max(right, 0)
    ]
    return moved
