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

"""Joint proposals from the pixels of a part, and the choice of their settings."""

import numpy as np
import pytest
from lsc_pose_experiments.shotton.joint_proposals import (
    MOST_STARTS,
    push_back,
    starts_of,
    surface_proposal,
)
from lsc_pose_experiments.shotton.part_pixels import PartCloud
from lsc_pose_experiments.shotton.proposal_training import USUAL, choose_settings, depth_offset

from lsc_pose_ros.pose.inference.density import VoteCloud


def cloud_of(points: np.ndarray, probability: np.ndarray) -> PartCloud:
    points, probability = points.astype(np.float32), probability.astype(np.float32)
    x, y, z = np.ascontiguousarray(points.T)
    return PartCloud(VoteCloud(x, y, z, probability * z * z), probability)


def blobs(seed: int, near: int, far: int) -> PartCloud:
    """Return a cloud with a blob of `near` points, and another of `far` points 1 m beside it."""
    rng = np.random.default_rng(seed)
    points = rng.normal(0, 0.04, (near + far, 3)) + np.array([0.2, -0.1, 2.0])
    points[near:, 0] += 1
    return cloud_of(points, rng.uniform(0.05, 1, near + far))


def twin(cloud: PartCloud, bandwidth: float, threshold: float) -> tuple[np.ndarray, float]:
    """Return the mode that most of the starts' weight reaches, and the fraction of the weight."""
    points = np.stack(cloud.votes[:3], axis=1).astype(float)
    starts = np.flatnonzero(cloud.probability >= np.float32(threshold))
    starts = starts[:: max(1, int(np.ceil(len(starts) / MOST_STARTS)))]
    if not len(starts):
        return np.full(3, np.nan), 0.0
    modes: list[np.ndarray] = []
    weights: list[float] = []
    for start in starts:
        here = points[start]
        for _ in range(50):
            squared = ((points - here) ** 2).sum(axis=1)
            pull = cloud.votes.weight * np.exp(-squared / bandwidth**2)
            before, here = here, pull @ points / pull.sum()
            if np.linalg.norm(here - before) < 0.01 * bandwidth:
                break
        near = [n for n, mode in enumerate(modes) if np.linalg.norm(mode - here) < bandwidth]
        if not near:
            modes.append(here)
            weights.append(0.0)
        weights[near[0] if near else -1] += float(cloud.votes.weight[start])
    best = int(np.argmax(weights))
    return modes[best], weights[best] / sum(weights)


@pytest.mark.parametrize(
    ('cloud', 'bandwidth', 'threshold'),
    [
        (blobs(0, 60, 20), 0.08, 0.1),
        (blobs(1, 30, 90), 0.05, 0.3),
        (blobs(2, 200, 150), 0.12, 0.5),
        (blobs(3, 1, 0), 0.05, 0.0),
        (blobs(4, 12, 0), 0.03, 1.1),  # no start
        (blobs(5, 0, 0), 0.05, 0.1),
        (cloud_of(np.ones((9, 3)), np.full(9, 0.5)), 0.05, 0.5),  # all at the same position
    ],
)
def test_proposal_equals_the_plain_one(cloud, bandwidth, threshold):
    found = surface_proposal(cloud, bandwidth, threshold)
    mode, confidence = twin(cloud, bandwidth, threshold)
    np.testing.assert_allclose(found[:3], mode, atol=0.02 * bandwidth)
    assert found.confidence == pytest.approx(confidence, abs=1e-4)


def test_proposal_is_the_larger_of_two_blobs():
    found = surface_proposal(blobs(0, 90, 30), 0.06, 0.2)
    np.testing.assert_allclose(found[:3], (0.2, -0.1, 2), atol=0.03)
    assert 0.5 < found.confidence < 1


@pytest.mark.parametrize('count', [0, 1, MOST_STARTS, MOST_STARTS + 1, 400])
def test_starts_are_taken_evenly(count):
    probability = np.full(count, 0.5, np.float32)
    starts = starts_of(probability, 0.5)
    assert len(starts) == min(count, len(starts)) <= MOST_STARTS
    assert len(set(np.diff(starts))) <= 1
    assert len(starts_of(probability, 0.6)) == 0


def test_push_back_follows_the_ray():
    pushed = push_back(np.array([[0.5, -0.2, 2.0], [np.nan] * 3], np.float32), 0.1)
    np.testing.assert_allclose(pushed[0], (0.525, -0.21, 2.1), rtol=1e-6)
    assert np.isnan(pushed[1]).all()


def test_depth_offset_is_that_of_joints_behind_their_proposals():
    rng = np.random.default_rng(0)
    surface = (rng.normal(0, 0.2, (30, 3)) + np.array([0, 0, 3])).astype(np.float32)
    joints = push_back(surface, 0.07)
    joints[:4] += 0.5  # wrong proposals
    surface[4] = np.nan
    assert depth_offset(surface, joints) == pytest.approx(0.07, abs=1e-5)
    assert depth_offset(surface[:5], joints[:5]) == USUAL.depth_offset


def test_settings_are_those_that_find_most_joints():
    """Most weight is in a wide blob of unlikely pixels, the joint is at the likely ones."""
    clouds, positions = [], []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        centre = rng.normal(0, 0.3, 3) + np.array([0, 0, 2.5])
        right = rng.normal(0, 0.02, (60, 3)) + centre
        wrong = rng.normal(0, 0.02, (300, 3)) + centre + np.array([0.6, 0, 0])
        probability = np.concatenate([np.full(60, 0.6), np.full(300, 0.2)])
        clouds.append(cloud_of(np.concatenate([right, wrong]), probability))
        positions.append(push_back(centre, 0.05))
    joints = np.array(positions, np.float32)
    joints[3] = np.nan
    settings = choose_settings(clouds, joints)
    assert settings.threshold > 0.2
    assert settings.depth_offset == pytest.approx(0.05, abs=0.01)
    for cloud, joint in zip(clouds[:3], joints[:3], strict=True):
        proposal = surface_proposal(cloud, settings.bandwidth, settings.threshold)
        found = push_back(np.array(proposal[:3]), settings.depth_offset)
        assert np.linalg.norm(found - joint) < 0.03


def test_settings_of_a_part_that_nobody_shows_are_the_usual_ones():
    assert choose_settings([], np.zeros((0, 3), np.float32)) == USUAL
    assert choose_settings([blobs(0, 5, 0)], np.full((1, 3), np.nan, np.float32)) == USUAL
