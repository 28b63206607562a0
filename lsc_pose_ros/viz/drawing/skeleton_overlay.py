"""Skeletons over an image: the person's left and right in colours of their own."""

from enum import Enum

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics, project
from lsc_pose_ros.data_types.joints import default_edges, names_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.viz.drawing.colours import LEFT, MIDDLE, RIGHT, TRUTH, bone_colour, side_colour
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots

_BONE, _BAND = 2.2, 5.0  # line widths, points


class Look(Enum):
    """How a skeleton is drawn."""

    SIDES = 'sides'  # in the colours of its sides
    TRUTH = 'truth'  # as a broad band below, which an estimate should run along


def draw_skeletons(
    axes: Axes, skeletons: Skeletons, camera: Intrinsics, look: Look = Look.SIDES
) -> None:
    """Draw all bodies of `skeletons` over the image that `camera` took."""
    for places in skeletons.positions:
        draw_bones(axes, skeletons.joints, project(places, camera), look)


def draw_bones(
    axes: Axes, joints: NDArray[np.uint16], places: NDArray[np.floating], look: Look = Look.SIDES
) -> None:
    """Draw one skeleton in the plane.

    Args:
        axes: where.
        joints: the joints' numbers, shape (J,).
        places: in the units of `axes`, NaN where unknown, shape (J, 2).
        look: how.
    """
    if look is Look.TRUTH:
        _draw_band(axes, joints, places)
        return
    names = names_of(joints)
    casing = [Stroke(linewidth=_BONE + 1.4, foreground='white'), Normal()]
    for parent, child in default_edges(joints):
        axes.plot(
            *places[[parent, child]].T,
            color=bone_colour(names[parent], names[child]),
            linewidth=_BONE,
            solid_capstyle='round',
            path_effects=casing,
            zorder=6,
        )
    colours = [side_colour(name) for name in names]
    draw_dots(axes, places, Dot(16, colours, rim='white', layer=7))


def _draw_band(axes: Axes, joints: NDArray[np.uint16], places: NDArray[np.floating]) -> None:
    for edge in default_edges(joints):
        axes.plot(*places[edge].T, color=TRUTH, linewidth=_BAND, solid_capstyle='round', zorder=4)
    draw_dots(axes, places, Dot(_BAND**2, TRUTH, layer=4))


def legend_lines(*, ground_truth: bool) -> list[Line2D]:
    """Return the legend's entries for skeletons; `ground_truth` if it is drawn below them."""
    sides = ((LEFT, "person's left"), (RIGHT, "person's right"), (MIDDLE, 'middle'))
    lines = [
        Line2D([], [], color=colour, linewidth=_BONE, marker='o', markersize=4, label=label)
        for colour, label in sides
    ]
    if ground_truth:
        lines.append(
            Line2D([], [], color=TRUTH, linewidth=_BAND, solid_capstyle='butt', label='truth')
        )
    return lines
