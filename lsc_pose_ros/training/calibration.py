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

"""Learns which share of the votes means which confidence, from people the forest has not seen.

For each joint, the confidence at a share s is the probability that a joint which so many votes
support lies within NEAR of the truth. It is estimated at evenly spaced shares (a person counts for
the two that are closest, by linear weights), and it may only rise with s: the least-squares fit
that does is found by pooling adjacent violators (Ayer et al., 1955).

A few people must not make a confidence 0 or 1, so each estimate begins with a prior. That of a
joint is the same estimate over all joints together; that of all joints is one half.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.inference.confidence import KNOTS, NEAR, vote_fractions
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly
from lsc_pose_ros.pose.stages import joint_stages, run_stages
from lsc_pose_ros.training.samples import Person

# How many people a prior stands for, at each of the shares.
_PRIOR = 0.2
_PRIOR_OF_A_JOINT = 5.0


class Evidence(NamedTuple):
    """What came of P people who were held out.

    Attributes:
        shares: which share of the votes supports each joint, shape (P, J).
        near: 1 where the joint lies within NEAR of the truth, 0 where not, NaN where there is no
            truth or no answer, shape (P, J).
    """

    shares: NDArray[np.float32]
    near: NDArray[np.float32]


def calibrate(model: Model, people: Iterable[Person]) -> Model:
    """Return `model` with a confidence that is right for `people`.

    Args:
        model: the forest must not have seen them.
        people: labelled; where there are none, the model stays as it is.
    """
    evidence = gather_evidence(model, people)
    if not len(evidence.near):
        return model
    return model._replace(
        calibration=fit_calibration(evidence),
        provenance=model.provenance | {'confidence learnt from': f'{len(evidence.near)} people'},
    )


def gather_evidence(model: Model, people: Iterable[Person]) -> Evidence:
    """Return how near to the truth `model` comes with `people`, and with how many votes."""
    stages = joint_stages(model)
    settings = model.settings
    shares: list[NDArray[np.float32]] = []
    near: list[NDArray[np.float32]] = []
    for person in people:
        queries = choose_uniformly(len(person.points), settings.query_points)
        points = person.points[queries] * np.float32(person.scale)
        body = BodyEstimate.from_descriptors(points, person.quantised[queries], person.scale)
        run_stages(stages, body)
        errors = np.linalg.norm(body.joints - person.joints * person.scale, axis=-1)
        shares.append(vote_fractions(body.joint_votes, body.joints, settings.joint_bandwidth))
        near.append(np.where(np.isnan(errors), np.nan, errors <= NEAR).astype(np.float32))
    shape = -1, len(model.joints)
    return Evidence(
        np.array(shares, np.float32).reshape(shape), np.array(near, np.float32).reshape(shape)
    )


def fit_calibration(evidence: Evidence) -> NDArray[np.float32]:
    """Return the confidence in each joint at KNOTS shares from 0 to 1, shape (J, KNOTS)."""
    counts = [
        _count(shares[~np.isnan(near)], near[~np.isnan(near)])
        for shares, near in zip(evidence.shares.T, evidence.near.T, strict=True)
    ]
    all_people, all_near = np.sum(counts, axis=0)
    together = _fit(all_people, all_near, _PRIOR, np.full(KNOTS, 0.5))
    joints = [_fit(people, near, _PRIOR_OF_A_JOINT, together) for people, near in counts]
    return np.array(joints, np.float32)


def _count(
    shares: NDArray[np.float32], near: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how many people each knot stands for, and how many of them are near, (KNOTS,)."""
    places = np.clip(shares, 0, 1) * (KNOTS - 1)
    knots = np.minimum(places.astype(np.int64), KNOTS - 2)
    parts = places - knots
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
    """Return the rising sequence with the least weighted squared distance to `values`.

    Args:
        values: shape (n,).
        weights: above 0, shape (n,).

    Neighbours that fall are replaced with their weighted mean until none do.
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
