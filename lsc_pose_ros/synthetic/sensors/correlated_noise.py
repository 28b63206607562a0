"""Noise that hangs together: neighbouring pixels of a sensor err alike."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import exact_kernel


class Nodes(NamedTuple):
    """How the pixels of one axis are interpolated between the nodes of a coarse grid.

    Attributes:
        first: the node before each pixel, shape (N,).
        weights: of that node and of the next one, their squares add up to 1, shape (N, 2).
    """

    first: NDArray[np.int64]
    weights: NDArray[np.float32]


def grain(
    shape: tuple[int, int], spacing: float, random: np.random.Generator
) -> NDArray[np.float32]:
    """Draw a field of normal noise with deviation 1 at each pixel, correlated over `spacing`.

    Independent values on a coarse grid at a random place, bilinear in between. With a spacing of
    a pixel or less all pixels are independent.

    Args:
        shape: rows and columns.
        spacing: of the grid, pixels.
        random: is asked for numbers always in the same order.

    Returns:
        The field, shape `shape`.
    """
    if spacing <= 1:
        return random.standard_normal(shape, dtype=np.float32)
    rows, columns = (place_nodes(count, spacing, random.random()) for count in shape)
    size = rows.first[-1] + 2, columns.first[-1] + 2
    field = np.empty(shape, np.float32)
    interpolate(random.standard_normal(size, dtype=np.float32), rows, columns, field)
    return field


def place_nodes(count: int, spacing: float, offset: float) -> Nodes:
    """Place nodes along an axis of `count` pixels; `offset` is in [0, 1) of the spacing.

    Linear interpolation would leave less noise between the nodes than at them:
    the variance is (1 - t)² + t² there, which is divided out.
    """
    place = np.arange(count) / spacing + offset
    first = np.floor(place).astype(np.int64)
    share = place - first
    weights = np.stack([1 - share, share], axis=1)
    weights /= np.sqrt((weights**2).sum(axis=1, keepdims=True))
    return Nodes(first, weights.astype(np.float32))


@exact_kernel
def interpolate(
    values: NDArray[np.float32], rows: Nodes, columns: Nodes, field: NDArray[np.float32]
) -> None:
    """Fill `field` with the values of a coarse grid, weighted bilinearly."""
    first, weights = columns
    height, width = field.shape
    for row in range(height):
        above = rows.first[row]
        upper, lower = rows.weights[row, 0], rows.weights[row, 1]
        for column in range(width):
            left = first[column]
            before = upper * values[above, left] + lower * values[above + 1, left]
            after = upper * values[above, left + 1] + lower * values[above + 1, left + 1]
            field[row, column] = weights[column, 0] * before + weights[column, 1] * after
