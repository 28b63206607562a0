"""Dots at places in the plane."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray


class Dot(NamedTuple):
    """How dots look.

    Attributes:
        size: their area, points squared.
        colour: of all, or of each.
        rim: the colour of their rims, 'none' for none.
        marker: their shape.
        layer: higher ones hide lower ones.
    """

    size: float
    colour: str | Sequence[str]
    rim: str = 'none'
    marker: str = 'o'
    layer: float = 2.0


def draw_dots(
    axes: Axes,
    places: NDArray[np.floating] | NDArray[np.integer],
    dot: Dot,
    strength: NDArray[np.floating] | None = None,
) -> None:
    """Draw a dot at each place.

    Args:
        axes: where.
        places: NaN for no dot, shape (n, 2).
        dot: how they look.
        strength: of each, from 0, invisible, to 1, shape (n,).
    """
    axes.scatter(
        x=places[:, 0],
        y=places[:, 1],
        s=dot.size,
        c=dot.colour,
        edgecolors=dot.rim,
        linewidths=0 if dot.rim == 'none' else 0.7,
        marker=dot.marker,
        alpha=strength,  # type: ignore[arg-type]  # its stubs know only one for all
        zorder=dot.layer,
    )
