# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Learns the confidence of a joint from its vote fraction, on people outside of the training.

The vote fraction s of a joint is the fraction of its votes near the estimate. Its confidence is
the probability that an estimate with this vote fraction lies within NEAR of the ground truth. It
is estimated at evenly spaced knots; each person counts at the two closest knots with linear
weights. Confidence must not decrease with s: the least-squares fit with this constraint is found
by pooling adjacent violators (Ayer et al., 1955).

A prior keeps a few people from making a confidence 0 or 1. The prior of a joint is the estimate
over all joints; the prior of that estimate is one half.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.inference.confidence import KNOTS, NEAR, vote_fractions
from lsc_pose_ros.pose.inference.truncation import truncation_factor
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly
from lsc_pose_ros.pose.stages import joint_stages, run_stages
from lsc_pose_ros.training.samples import LabelledPerson

# The weight of a prior at each knot, in people.
_PRIOR = 0.2
_PRIOR_OF_A_JOINT = 5.0


class CalibrationData(NamedTuple):
    """The results of P held-out people.

    Attributes:
        fractions: the vote fraction of each joint, shape (P, J).
        near: 1 if the joint lies within NEAR of the ground truth, 0 if not, NaN without ground
            truth or estimate, and near a cut, where a factor lowers the confidence; (P, J).
    """

    fractions: NDArray[np.float32]
    near: NDArray[np.float32]


def calibrate(model: Model, people: Iterable[LabelledPerson]) -> Model:
    """Return `model` with confidences that are calibrated on `people`.

    Args:
        model: a model that was not trained on `people`.
        people: labelled people; without any, `model` is returned unchanged.
    """
    data = gather_calibration_data(model, people)
    if not len(data.near):
        return model
    return model._replace(
        calibration=fit_calibration(data),
        provenance=model.provenance | {'confidence learnt from': f'{len(data.near)} people'},
    )


def gather_calibration_data(model: Model, people: Iterable[LabelledPerson]) -> CalibrationData:
    """Return the vote fractions of the joints of `people`, and whether `model` is near."""
    stages = joint_stages(model)
    settings = model.settings
    fractions: list[NDArray[np.float32]] = []
    near: list[NDArray[np.float32]] = []
    for person in people:
        queries = choose_uniformly(len(person.points), settings.query_points)
        points = person.points[queries] * np.float32(person.scale)
        body = BodyEstimate.from_descriptors(points, person.quantised[queries], person.scale)
        run_stages(stages, body)
        errors = np.linalg.norm(body.joints - person.joints * person.scale, axis=-1)
        fractions.append(vote_fractions(body.joint_votes, body.joints, settings.joint_bandwidth))
        factor = truncation_factor(body.joints, person.cuts, model.joints)
        unknown = np.isnan(errors) | (factor < 1)
        near.append(np.where(unknown, np.nan, errors <= NEAR).astype(np.float32))
    shape = -1, len(model.joints)
    return CalibrationData(
        np.array(fractions, np.float32).reshape(shape), np.array(near, np.float32).reshape(shape)
    )


def fit_calibration(data: CalibrationData) -> NDArray[np.float32]:
    """Return the confidence of each joint at KNOTS vote fractions from 0 to 1, (J, KNOTS)."""
    counts = [
        _count(fractions[~np.isnan(near)], near[~np.isnan(near)])
        for fractions, near in zip(data.fractions.T, data.near.T, strict=True)
    ]
    all_people, all_near = np.sum(counts, axis=0)
    together = _fit(all_people, all_near, _PRIOR, np.full(KNOTS, 0.5))
    joints = [_fit(people, near, _PRIOR_OF_A_JOINT, together) for people, near in counts]
    return np.array(joints, np.float32)


def _count(
    fractions: NDArray[np.float32], near: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the number of people at each knot, and of those that are near, (KNOTS,)."""
    positions = np.clip(fractions, 0, 1) * (KNOTS - 1)
    knots = np.minimum(positions.astype(np.int64), KNOTS - 2)
    parts = positions - knots
    people = np.zeros(KNOTS)
    hits = np.zeros(KNOTS)
    for knot, part in ((knots, 1 - parts), (knots + 1, parts)):
        np.add.at(people, knot, part)
        np.add.at(hits, knot, part * near)
    return people, hits


def _fit(
    people: NDArray[np.float64],
    near: NDArray[np.float64],
    weight: float,
    prior: NDArray[np.float64],
) -> NDArray[np.float64]:
    total = people + weight
    return pool_adjacent_violators((near + weight * prior) / total, total)


def pool_adjacent_violators(
    values: NDArray[np.float64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the non-decreasing sequence with the least weighted squared distance to `values`.

    Neighbours that decrease are replaced by their weighted mean until none do.

    Args:
        values: shape (n,).
        weights: positive, shape (n,).
    """
    means: list[float] = []
    totals: list[float] = []
    lengths: list[int] = []
    for value, weight in zip(values.tolist(), weights.tolist(), strict=True):
        mean, total, length = value, weight, 1
        while means and means[-1] >= mean:
            before = totals.pop()
            mean = (means.pop() * before + mean * total) / (before + total)
            total += before
            length += lengths.pop()
        means.append(mean)
        totals.append(total)
        lengths.append(length)
    return np.repeat(means, lengths)
