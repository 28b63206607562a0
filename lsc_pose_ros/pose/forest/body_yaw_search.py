"""Finds where a person faces: the forest is told one direction after the other.

Seen from behind, a person has the left hand where, seen from before, the right one would be, and
the surroundings of a single point hardly tell which it is. Told where the person faces, the forest
need not know. Told a wrong direction, it takes what each point sees for something else, and its
votes contradict each other. So the direction is right of which the votes agree.

Forests that are conditioned on what all of a body tells are those of Sun, Kohli and Shotton,
Conditional regression forests for human pose estimation (CVPR 2012). This goes beyond the paper.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.body_yaw import body_yaws_around, with_body_yaw
from lsc_pose_ros.pose.forest.forest import find_leaves
from lsc_pose_ros.pose.forest.votes import Votes, VoteSettings, gather_votes, votes_for
from lsc_pose_ros.pose.inference.confidence import vote_fraction_near
from lsc_pose_ros.pose.inference.density import find_modes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly

# So many of a person's points are asked in every direction; more change little.
_FEW = 60

# The directions that come out best are then told to all points: at most so many, and none on which
# the few agreed less than this share of the best. Mostly that leaves one.
_SHORTLIST = 3
_NEARLY_BEST = 0.9


def leaves_of(
    model: Model, points: NDArray[np.float32], quantised: NDArray[np.uint8], scale: float
) -> NDArray[np.int32]:
    """Return the leaf that each point of a person reaches in each tree of a model, shape (Q, T).

    Args:
        model: if its trees know facings, they are told where the person faces.
        points: the person's points that vote, metres, shape (Q, 3).
        quantised: their descriptors, shape (Q, F).
        scale: rho_bar, metres.
    """
    if model.settings.body_yaws == 0:
        return find_leaves(model.forest, quantised)
    body_yaw = find_body_yaw(model, points, quantised, scale)
    return find_leaves(model.forest, with_body_yaw(quantised, body_yaw))


def find_body_yaw(
    model: Model, points: NDArray[np.float32], quantised: NDArray[np.uint8], scale: float
) -> float:
    """Return where a person faces, radians, as `body_yaw_of`: where the votes agree most.

    A few points try all directions, and all points the best of these where one alone does not
    stand out. Between two directions the agreement runs as a parabola through three of them does.

    Arguments as `leaves_of`; the trees know facings.
    """
    directions = body_yaws_around(model.settings.body_yaws)
    few = choose_uniformly(len(points), _FEW)
    person = points[few], quantised[few], scale
    rough = np.array([agreement_on(model, *person, body_yaw) for body_yaw in directions])
    shortlist = np.argsort(-rough)[:_SHORTLIST]
    shortlist = shortlist[rough[shortlist] >= _NEARLY_BEST * rough.max()]
    best = int(shortlist[0])
    if len(shortlist) > 1:
        exact = [agreement_on(model, points, quantised, scale, directions[n]) for n in shortlist]
        best = int(shortlist[np.argmax(exact)])
    return float(directions[best] + peak_beside(rough, best) * 2 * np.pi / len(directions))


def peak_beside(values: NDArray[np.float64], index: int) -> float:
    """Return how far beside `index` the peak of `values`, on a circle, lies: from -0.5 to 0.5.

    Args:
        values: shape (n,).
        index: of one that is large, though it need not be the largest.
    """
    before, here, after = values[index - 1], values[index], values[(index + 1) % len(values)]
    bend = before - 2 * here + after
    if bend >= 0:  # no peak in between
        return 0.5 * float(np.sign(after - before))
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5))


def agreement_on(
    model: Model,
    points: NDArray[np.float32],
    quantised: NDArray[np.uint8],
    scale: float,
    body_yaw: float,
) -> float:
    """Return how well the votes agree where the trees are told that the person faces there.

    Other arguments as `leaves_of`; `body_yaw` in radians.
    """
    settings = model.settings
    leaves = find_leaves(model.forest, with_body_yaw(quantised, body_yaw))
    vote_settings = VoteSettings(len(model.joints), settings.heaviest_votes, scale)
    votes = gather_votes(model.forest.joint_votes, leaves, points, vote_settings)
    return agreement(votes, settings.joint_bandwidth)


@kernel
def agreement(votes: Votes, bandwidth: float) -> float:
    """Return the share of the votes that is behind each joint's best mode, summed over the joints.

    Args:
        votes: for each joint (eq. 13).
        bandwidth: h_j, metres (eq. 14).
    """
    total = 0.0
    for joint in range(votes.start.shape[0] - 1):
        cloud = votes_for(votes, joint)
        modes = find_modes(cloud, bandwidth, 1)
        if modes.shape[0] > 0:
            total += float(vote_fraction_near(modes[0], cloud, bandwidth))
    return total
