"""One point's descriptor: its neighbours in the image and the bins that they fill (eq. 3, 4)."""

import math
from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import project
from lsc_pose_ros.plain.descriptor import describe, describe_by_nearest_bin
from lsc_pose_ros.pose.features.shape_context_3d import AZIMUTH_BINS, RADIUS_BINS, ZENITH_BINS
from lsc_pose_ros.viz.drawing.canvas import hide_axes, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER, EDGE, FILLING, MIDDLE, RIGHT
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.seen_body import SeenBody


def shown_point(seen: SeenBody) -> int:
    """Return the silhouette point whose descriptor is drawn: the one farthest to a side."""
    x = seen.shape.silhouette.points[:, 0]
    return int(np.abs(x - x.mean()).argmax())


def bin_radii(reach: float, inner_radius: float) -> NDArray[np.float64]:
    """Return where radius bins begin and end, metres, shape (RADIUS_BINS + 1,).

    Args:
        reach: how far the descriptor reaches, metres.
        inner_radius: the inner limit of the first bin, as a share of `reach`.
    """
    return reach * inner_radius ** np.linspace(1, 0, RADIUS_BINS + 1)


def draw_feature(axes: Axes, seen: SeenBody) -> None:
    """Draw the bins of one descriptor, or say that the model's feature has no picture."""
    if seen.settings.feature == '3dlsc':
        draw_bins(axes, seen)
        return
    hide_axes(axes)
    sentence = (
        f'The feature of this model, {seen.settings.feature}, is not drawn; '
        'only that of the paper, 3dlsc, is.'
    )
    axes.text(0.5, 0.5, fill(sentence, 24), ha='center', va='center', transform=axes.transAxes)
    axes.set_title('the feature of one point')


def draw_bins(axes: Axes, seen: SeenBody) -> None:
    """Draw the bins of one descriptor, seen from the camera, and the points within."""
    draw_depth(axes, seen.frame, seen.box, body=seen.body)
    camera, points = seen.frame.camera, seen.shape.silhouette.points
    reach = seen.shape.scale * seen.settings.support_radius
    centre = points[shown_point(seen)]
    inside = np.linalg.norm(points - centre, axis=1) <= reach
    pixels = project(points, camera)
    draw_dots(axes, pixels[~inside], Dot(3, BORDER))
    middle = project(centre, camera)
    radii = bin_radii(reach, seen.settings.inner_radius) * camera.fx / centre[2]
    for radius in radii:
        axes.add_patch(
            Circle((middle[0], middle[1]), radius, fill=False, edgecolor=MIDDLE, linewidth=0.6)
        )
    for azimuth in np.arange(AZIMUTH_BINS) * (2 * math.pi / AZIMUTH_BINS):
        way = np.array([math.cos(azimuth), math.sin(azimuth)])
        ends = np.stack([middle + radii[0] * way, middle + radii[-1] * way])
        axes.plot(*ends.T, color=MIDDLE, linewidth=0.4)
    draw_dots(axes, pixels[inside], Dot(4, EDGE, layer=3))
    draw_dots(axes, middle[None], Dot(28, RIGHT, rim='white', layer=4))
    axes.set_title('the bins of one point')


def descriptor_figure(seen: SeenBody) -> Figure:
    """Return the picture of one descriptor: its bins on the body, and how full they are."""
    figure = new_figure(7.6, 3.9)
    reach = seen.shape.scale * seen.settings.support_radius
    figure.suptitle(f'one descriptor, which reaches {100 * reach:.0f} cm')
    parts = figure.subfigures(1, 2, squeeze=False, width_ratios=(0.8, 1.4))
    left, right = parts[0]
    draw_bins(left.subplots(), seen)
    # The picture shows shares; what the forest sees is their levels.
    points, shown = seen.shape.silhouette.points, np.array([shown_point(seen)])
    nearest = seen.settings.binning == 'nearest'
    histograms = (describe_by_nearest_bin if nearest else describe)(
        points, shown, reach, seen.settings.inner_radius
    )
    histogram = histograms[0]
    filled = histogram.reshape(RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS)
    grid = right.subplots(2, 3, subplot_kw={'projection': 'polar'}).ravel()
    for zenith, axes in enumerate(grid):
        _draw_rose(axes, filled[:, :, zenith], float(filled.max()))
        axes.set_title(_zenith_name(zenith), pad=2)
    scale = ScalarMappable(Normalize(0, float(filled.max())), FILLING)
    bar = right.colorbar(scale, ax=list(grid), shrink=0.7, aspect=30, pad=0.02)
    bar.outline.set_visible(False)
    bar.set_label('share of the points within reach')
    return figure


def _draw_rose(axes: PolarAxes, filled: NDArray[np.float32], highest: float) -> None:
    """Draw the bins of one zenith range, shape (radius, azimuth), as seen from the camera."""
    # y points down in the image, so the azimuth turns clockwise.
    axes.set_theta_direction(-1)
    step = 2 * math.pi / AZIMUTH_BINS
    colours = mpl.colormaps[FILLING](Normalize(0, highest)(filled))
    for radius in range(RADIUS_BINS):
        axes.bar(
            step * np.arange(AZIMUTH_BINS), 1, step, radius + 0.5, align='edge',
            color=colours[radius], edgecolor=BORDER, linewidth=0.4,
        )  # fmt: skip
    axes.set_ylim(0, RADIUS_BINS + 0.5)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines['polar'].set_visible(False)


def _zenith_name(zenith: int) -> str:
    step = 180 // ZENITH_BINS
    name = f'{zenith * step}\N{EN DASH}{(zenith + 1) * step}°'
    ends = {0: ' behind', ZENITH_BINS - 1: ' in front'}
    return name + ends.get(zenith, '')
