"""How sure an answer is: what share of the votes is behind a joint, and how often that is right.

Of the joints with confidence c, about a share c lies within NEAR of the truth. Which share of the
votes means which confidence is learnt, joint by joint, from people that the forest has not seen
(`learning/calibration.py`). A model that was never told so gives the share of the votes itself.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.votes import Votes, votes_for
from lsc_pose_ros.pose.inference.density import Cloud, Place, density

NEAR = 0.1
"""How far from the truth a joint may lie that is as good as it claims, metres."""

KNOTS = 41
"""At how many shares of the votes, evenly from 0 to 1, a model knows the confidence."""


def uncalibrated() -> NDArray[np.float32]:
    """Return the calibration of a model that has none, shape (0, KNOTS)."""
    return np.zeros((0, KNOTS), np.float32)


@kernel
def support(votes: Votes, places: NDArray[np.float32], bandwidth: float) -> NDArray[np.float32]:
    """Return which share of the votes' weight supports each place, 0 to 1, shape (J,)."""
    shares = np.zeros(places.shape[0], np.float32)
    for joint in range(places.shape[0]):
        cloud = votes_for(votes, joint)
        if cloud.x.shape[0] == 0 or math.isnan(places[joint, 0]):
            continue
        shares[joint] = vote_fraction_near(places[joint], cloud, bandwidth)
    return shares


@kernel
def vote_fraction_near(place: Place, cloud: Cloud, bandwidth: float) -> np.float32:
    """Return which share of the weight of votes for one joint supports a place, 0 to 1.

    Args:
        place: metres, shape (3,).
        cloud: the votes, one at least.
        bandwidth: h_j, metres.
    """
    return density(place, cloud, bandwidth) / np.sum(cloud.weight)


@kernel
def confidence_in(
    calibration: NDArray[np.float32],
    votes: Votes,
    places: NDArray[np.float32],
    bandwidth: float,
) -> NDArray[np.float32]:
    """Return the confidence in each place, 0 to 1, shape (J,); a place that is NaN has 0.

    Args:
        calibration: as in Model, shape (J, K) or (0, K).
        votes: for each joint (eq. 13).
        places: the joints, metres, shape (J, 3).
        bandwidth: h_j, metres.
    """
    shares = support(votes, places, bandwidth)
    if calibration.shape[0] == 0:
        return shares
    steps = calibration.shape[1] - 1
    confidence = np.zeros_like(shares)
    for joint in range(places.shape[0]):
        if math.isnan(places[joint, 0]):
            continue
        place = min(max(shares[joint], np.float32(0)), np.float32(1)) * np.float32(steps)
        knot = min(int(place), steps - 1)
        part = place - np.float32(knot)
        before, after = calibration[joint, knot], calibration[joint, knot + 1]
        confidence[joint] = before + part * (after - before)
    return confidence
