"""The votes of the silhouette points for joints and for bones (eq. 13)."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import project
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.viz.drawing.colours import MIDDLE, bone_colour, side_colour
from lsc_pose_ros.viz.drawing.depth_image import draw_depth
from lsc_pose_ros.viz.drawing.dots import Dot, draw_dots
from lsc_pose_ros.viz.stages.seen_body import Estimated, SeenBody


def draw_joint_votes(axes: Axes, seen: SeenBody, estimated: Estimated) -> None:
    """Draw where the points say that the joints are: the heaviest votes, fainter if lighter."""
    draw_depth(axes, seen.frame, seen.box, body=seen.body)
    votes = estimated.stages.joint_votes
    for joint, name in enumerate(names_of(estimated.model.joints)):
        places, weights = votes_for(votes, joint)
        _scatter(axes, project(places, seen.frame.camera), weights, side_colour(name))
    axes.set_title('votes for the joints')


def draw_pair_votes(axes: Axes, seen: SeenBody, estimated: Estimated) -> None:
    """Draw where the points say that each child joint is, seen from its parent."""
    draw_depth(axes, seen.frame, seen.box, body=seen.body)
    names = names_of(estimated.model.joints)
    joints, votes = estimated.stages.joints, estimated.stages.pair_votes
    for edge, (parent, child) in enumerate(estimated.model.edges):
        offsets, weights = votes_for(votes, edge)
        colour = bone_colour(names[parent], names[child])
        _scatter(axes, project(joints[parent] + offsets, seen.frame.camera), weights, colour)
    for parent, child in estimated.model.edges:
        bone = project(joints[[parent, child]], seen.frame.camera)
        axes.plot(*bone.T, color=MIDDLE, linewidth=0.7)
    parents = project(joints[np.unique(estimated.model.edges[:, 0])], seen.frame.camera)
    draw_dots(axes, parents, Dot(10, MIDDLE, rim='white', layer=4))
    axes.set_title('votes for the bones')


def votes_for(votes: Votes, target: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the places, (M, 3), and weights, (M,), of the votes for one joint or edge."""
    mine = slice(votes.start[target], votes.start[target + 1])
    return votes.place[mine], votes.weight[mine]


def _scatter(
    axes: Axes, pixels: NDArray[np.float32], weights: NDArray[np.float32], colour: str
) -> None:
    if len(weights) == 0:
        return
    strength = 0.08 + 0.42 * weights / weights.max()
    draw_dots(axes, pixels, Dot(6, colour, layer=3), strength)
