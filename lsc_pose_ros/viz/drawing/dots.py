"""Dots: markers at positions in axes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray


class Dot(NamedTuple):
    """The look of dots.

    Attributes:
        size: the area, points squared.
        colour: one colour for all, or one for each.
        rim: the colour of the rim, 'none' for none.
        marker: the shape, a matplotlib marker.
        layer: dots in higher layers hide those in lower ones.
    """

    size: float
    colour: str | Sequence[str]
    rim: str = 'none'
    marker: str = 'o'
    layer: float = 2.0


def draw_dots(
    axes: Axes,
    positions: NDArray[np.floating] | NDArray[np.integer],
    dot: Dot,
    opacity: NDArray[np.floating] | None = None,
) -> None:
    """Draw a dot at each position.

    Args:
        axes: the axes.
        positions: x and y, NaN for no dot, shape (n, 2).
        dot: the look.
        opacity: of each dot, from 0, invisible, to 1, shape (n,).
    """
    axes.scatter(
        x=positions[:, 0],
        y=positions[:, 1],
        s=dot.size,
        c=dot.colour,
        edgecolors=dot.rim,
        linewidths=0 if dot.rim == 'none' else 0.7,
        marker=dot.marker,
        alpha=opacity,  # type: ignore[arg-type]  # the stubs allow only one number
        zorder=dot.layer,
    )
