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

"""The lengths of the limbs: learnt over frames, compared between bodies."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS, numbers_of
from lsc_pose_ros.tracking.body_size import (
    LEAST_KNOWN,
    LENGTH_ERROR,
    LONGEST_MEMORY,
    MOST_DIFFERENT,
    BodySize,
    limbs_of,
    size_difference,
    size_in_frame,
)

LIMBS = np.array([[0, 1], [1, 2], [0, 3]], np.int32)


def test_the_limbs_are_the_edges_and_the_trunk() -> None:
    limbs = limbs_of(np.arange(20, dtype=np.uint16))
    assert len(limbs) == 19
    assert [JOINT_NUMBERS['torso'], JOINT_NUMBERS['pelvis']] in limbs.tolist()
    assert len(limbs_of(numbers_of(['head', 'neck']))) == 1
    assert limbs_of(numbers_of(['head'])).shape == (0, 2)


def test_the_lengths_are_means_that_weigh_by_the_less_certain_end() -> None:
    rng = np.random.default_rng(0)
    frames = [(rng.normal(0, 1, (4, 3)), rng.uniform(0.1, 1, 4)) for _ in range(9)]
    frames[4][0][2] = np.nan
    size = BodySize(np.zeros(3), np.zeros(3))
    for joints, confidence in frames:
        seen = size_in_frame(joints.astype(np.float32), confidence.astype(np.float32), LIMBS)
        size = size.updated(seen)
    for limb, (a, b) in enumerate(LIMBS):
        terms = [
            (min(confidence[a], confidence[b]), np.linalg.norm(joints[a] - joints[b]))
            for joints, confidence in frames
            if np.isfinite(joints[[a, b]]).all()
        ]
        weight = sum(w for w, _ in terms)
        assert size.weight[limb] == pytest.approx(weight, rel=1e-5)
        assert size.lengths[limb] == pytest.approx(sum(w * x for w, x in terms) / weight, rel=1e-5)


def test_old_lengths_fade() -> None:
    size = BodySize(np.array([1.0]), np.array([LONGEST_MEMORY]))
    grown = BodySize(np.array([2.0]), np.array([1.0]))
    for _ in range(round(3 * LONGEST_MEMORY)):
        size = size.updated(grown)
    assert size.weight[0] == LONGEST_MEMORY
    # (1 - 1 / 61)^180 of the old length is left.
    assert size.lengths[0] == pytest.approx(2 - (1 - 1 / (LONGEST_MEMORY + 1)) ** 180)


def test_the_difference_is_bounded_and_counts_what_is_known() -> None:
    known = BodySize(np.array([0.3, 0.4, 0.5]), np.array([10.0, 10.0, 0.0]))
    other = BodySize(np.array([0.35, 0.4, 0.9]), np.array([0.5, 1.0, 1.0]))
    expected = 0.5 * (0.05 / LENGTH_ERROR) ** 2 / 3
    assert size_difference(known, other) == pytest.approx(expected)
    assert size_difference(known, other._replace(lengths=other.lengths + 1)) == MOST_DIFFERENT
    young = known._replace(weight=np.full(3, LEAST_KNOWN - 0.1))
    assert size_difference(young, other) == 0
    nothing = BodySize(np.zeros(0), np.zeros(0))
    assert size_difference(nothing, nothing) == 0
