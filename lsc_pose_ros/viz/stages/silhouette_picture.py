"""From depth to silhouette: the first pictures of the way (eq. 1 and 2)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from matplotlib.ticker import MaxNLocator

from lsc_pose_ros.data_types.camera import project
from lsc_pose_ros.viz.drawing.canvas import hide_axes
from lsc_pose_ros.viz.drawing.colours import DIVERGING, EDGE, FAINT, MIDDLE, SEQUENTIAL
from lsc_pose_ros.viz.drawing.crop import look_at
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.seen_body import SeenBody


def draw_metres(axes: Axes, seen: SeenBody) -> None:
    """Draw the body's depth in metres."""
    frame = seen.frame
    hide_axes(axes)
    shown = (frame.labels == seen.body) & (frame.depth > 0)
    metres = np.where(shown, frame.depth, np.nan)
    near, far = np.nanpercentile(metres, [1, 99])
    image = axes.imshow(metres, cmap=f'{SEQUENTIAL}_r', vmin=near, vmax=far)
    look_at(axes, seen.box)
    axes.set_title('depth of the body, m')
    _add_scale(axes, image)


def draw_smoothing(axes: Axes, seen: SeenBody) -> None:
    """Draw by how much smoothing moves each pixel, in millimetres (eq. 1)."""
    hide_axes(axes)
    window, smoothed = seen.shape.window, seen.shape.silhouette.smoothed
    with np.errstate(invalid='ignore'):  # the background is infinitely far
        moved = 1000 * (smoothed.depth - window.depth)
    limit = max(float(np.nanpercentile(np.abs(moved), 98)), 1e-3)
    height, width = moved.shape
    left, top = window.column - 0.5, window.row - 0.5
    image = axes.imshow(
        moved,
        cmap=DIVERGING,
        vmin=-limit,
        vmax=limit,
        extent=(left, left + width, top + height, top),
    )
    _draw_outline(axes, seen)
    look_at(axes, seen.box)
    axes.set_title('change by smoothing, mm')
    _add_scale(axes, image)


def draw_silhouette(axes: Axes, seen: SeenBody) -> None:
    """Draw all edge pixels E and the points E' that are kept of them (eq. 2).

    Where the settings sample the whole body, E are all of its pixels.
    """
    silhouette = seen.shape.silhouette
    draw_depth(axes, seen.frame, seen.box, body=seen.body)
    edges = np.stack([silhouette.columns, silhouette.rows], axis=1)
    draw_dots(axes, edges, Dot(3, EDGE, marker='s'))
    kept = project(silhouette.points, seen.frame.camera)
    draw_dots(axes, kept, Dot(3.5, MIDDLE, layer=3))
    name = 'points' if seen.settings.sample == 'body' else 'silhouette'
    axes.set_title(f'{name}: {len(silhouette.points)} of {len(silhouette.rows)}')


def _draw_outline(axes: Axes, seen: SeenBody) -> None:
    """Draw where the body ends."""
    mask = (seen.frame.labels == seen.body).astype(float)
    axes.contour(mask, levels=[0.5], colors=[FAINT], linewidths=0.6)


def _add_scale(axes: Axes, image: AxesImage) -> None:
    """Put the scale of the colours below the picture."""
    inset = axes.inset_axes((0.2, 0.034, 0.6, 0.016))
    bar = axes.figure.colorbar(image, cax=inset, orientation='horizontal')
    bar.outline.set_visible(False)
    inset.tick_params(length=2, pad=1, labelsize=7)
    inset.xaxis.set_major_locator(MaxNLocator(4))
