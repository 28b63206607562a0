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

from lsc_pose_ros.core.confidence import share_behind
from lsc_pose_ros.core.density import find_modes
from lsc_pose_ros.core.facing import facings_around, with_facing
from lsc_pose_ros.core.forest import find_leaves
from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.core.model import Model
from lsc_pose_ros.core.silhouette import choose_uniformly
from lsc_pose_ros.core.votes import CastVotes, Poll, cast_votes, votes_for

# So many of a person's points are asked in every direction; more change little.
_FEW = 60

# The directions that come out best are then told to all points: at most so many, and none on which
# the few agreed less than this share of the best. Mostly that leaves one.
_SHORTLIST = 3
_NEARLY_BEST = 0.9


def leaves_of(
    model: Model, points: NDArray[np.float32], levels: NDArray[np.uint8], scale: float
) -> NDArray[np.int32]:
    """Return the leaf that each point of a person reaches in each tree of a model, shape (Q, T).

    Args:
        model: if its trees know facings, they are told where the person faces.
        points: the person's points that vote, metres, shape (Q, 3).
        levels: their descriptors, shape (Q, F).
        scale: rho_bar, metres.
    """
    if model.settings.facings == 0:
        return find_leaves(model.forest, levels)
    facing = find_facing(model, points, levels, scale)
    return find_leaves(model.forest, with_facing(levels, facing))


def find_facing(
    model: Model, points: NDArray[np.float32], levels: NDArray[np.uint8], scale: float
) -> float:
    """Return where a person faces, radians, as `facing_of`: where the votes agree most.

    A few points try all directions, and all points the best of these where one alone does not
    stand out. Between two directions the agreement runs as a parabola through three of them does.

    Arguments as `leaves_of`; the trees know facings.
    """
    directions = facings_around(model.settings.facings)
    few = choose_uniformly(len(points), _FEW)
    person = points[few], levels[few], scale
    rough = np.array([agreement_on(model, *person, facing) for facing in directions])
    shortlist = np.argsort(-rough)[:_SHORTLIST]
    shortlist = shortlist[rough[shortlist] >= _NEARLY_BEST * rough.max()]
    best = int(shortlist[0])
    if len(shortlist) > 1:
        exact = [agreement_on(model, points, levels, scale, directions[n]) for n in shortlist]
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
    levels: NDArray[np.uint8],
    scale: float,
    facing: float,
) -> float:
    """Return how well the votes agree where the trees are told that the person faces there.

    Other arguments as `leaves_of`; `facing` in radians.
    """
    settings = model.settings
    leaves = find_leaves(model.forest, with_facing(levels, facing))
    poll = Poll(len(model.joints), settings.heaviest_votes, scale)
    votes = cast_votes(model.forest.joint_votes, leaves, points, poll)
    return agreement(votes, settings.joint_bandwidth)


@kernel
def agreement(votes: CastVotes, bandwidth: float) -> float:
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
            total += float(share_behind(modes[0], cloud, bandwidth))
    return total
