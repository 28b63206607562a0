"""What the graph does: the joints alone, the best combination, and after ascent (eq. 16, 17)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import back_project, project
from lsc_pose_ros.viz.drawing.canvas import hide_axes, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.drawing.legend import LEGEND_HEIGHT, place_legend
from lsc_pose_ros.viz.drawing.skeleton_overlay import Look, draw_bones, legend_lines
from lsc_pose_ros.viz.stages.seen_body import Estimated, SeenBody

_MOST_DOTS = 4000


def draw_answer(axes: Axes, seen: SeenBody, estimated: Estimated) -> None:
    """Draw the final skeleton over the image, and the truth below it."""
    _draw_front(axes, seen, estimated, estimated.stages.joints)
    axes.set_title('joints' + _error(seen, estimated, estimated.stages.joints))


def skeleton_figure(seen: SeenBody, estimated: Estimated) -> Figure:
    """Return the skeletons on the way, from the camera and from the camera's right."""
    stages = estimated.stages
    steps = {
        'each joint alone': stages.alone,
        'best combination': stages.chosen,
        'after ascent': stages.joints,
    }
    figure = new_figure(7.6, 6.6 + LEGEND_HEIGHT)
    grid = figure.subplots(2, len(steps))
    for column, (name, joints) in enumerate(steps.items()):
        _draw_front(grid[0, column], seen, estimated, joints)
        _draw_side(grid[1, column], seen, estimated, joints)
        grid[0, column].set_title(name + _error(seen, estimated, joints))
    known = np.isfinite(seen.ground_truth(estimated.model.joints)).any()
    place_legend(figure, legend_lines(ground_truth=bool(known)))
    return figure


def _draw_front(
    axes: Axes, seen: SeenBody, estimated: Estimated, joints: NDArray[np.float32]
) -> None:
    draw_depth(axes, seen.frame, seen.box, body=seen.body)
    numbers, camera = estimated.model.joints, seen.frame.camera
    draw_bones(axes, numbers, project(seen.ground_truth(numbers), camera), Look.TRUTH)
    draw_bones(axes, numbers, project(joints, camera))


def _draw_side(
    axes: Axes, seen: SeenBody, estimated: Estimated, joints: NDArray[np.float32]
) -> None:
    """Draw metres in the plane of z, to the left is nearer, and y."""
    hide_axes(axes)
    frame, numbers = seen.frame, estimated.model.joints
    rows, columns = np.nonzero((frame.labels == seen.body) & (frame.depth > 0))
    step = max(1, len(rows) // _MOST_DOTS)
    rows, columns = rows[::step], columns[::step]
    surface = back_project(columns, rows, frame.depth[rows, columns], frame.camera)
    draw_dots(axes, surface[:, [2, 1]], Dot(1.5, BORDER))
    draw_bones(axes, numbers, seen.ground_truth(numbers)[:, [2, 1]], Look.TRUTH)
    draw_bones(axes, numbers, joints[:, [2, 1]])
    axes.set_aspect('equal')
    axes.invert_yaxis()
    axes.set_title('from the side (camera at left)', pad=2)


def _error(seen: SeenBody, estimated: Estimated, joints: NDArray[np.float32]) -> str:
    """Return the mean error as part of a title, '' where there is no truth."""
    distance = np.linalg.norm(joints - seen.ground_truth(estimated.model.joints), axis=-1)
    known = distance[np.isfinite(distance)]
    return f': {100 * known.mean():.1f} cm' if len(known) else ''
