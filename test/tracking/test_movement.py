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

"""Where a body is expected, and how unlikely another place is."""

import math

import numpy as np
import pytest

from lsc_pose_ros.tracking.movement import (
    AREA_SECONDS,
    ERROR,
    FADING_SECONDS,
    FASTEST,
    HEIGHT_WEIGHT,
    LARGEST_COST,
    LARGEST_GAP,
    PART_ERROR,
    SETTLING_SECONDS,
    SPREAD,
    Movement,
    at_rest,
)
from lsc_pose_ros.tracking.surfaces import Surface

SECOND = 1_000_000_000


def surface(x: float, y: float = 0.0, z: float = 2.0, area: float = 0.5) -> Surface:
    return Surface(np.array([x, y, z]), area)


@pytest.mark.parametrize('seed', range(20))
def test_the_cost_is_that_of_a_normal_density_that_widens(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place, velocity = rng.normal(0, 0.1, 3), rng.normal(0, 0.5, 3)
    seconds = float(rng.uniform(0, 1))
    hidden, area = rng.uniform(0, 1, 2)
    found = Movement(0, place, velocity, 0.5, hidden).cost(
        round(seconds * SECOND), Surface(np.zeros(3), area)
    )
    # The velocity fades: the integral of v exp(-t / t0).
    steps = (np.arange(10_000) + 0.5) / 10_000 * seconds
    walked = velocity * np.exp(-steps / FADING_SECONDS).mean() * seconds
    off = place + walked
    distance = math.hypot(off[0], HEIGHT_WEIGHT * off[1], off[2])
    error = ERROR + SPREAD * seconds
    part = PART_ERROR * math.sqrt(hidden + max(1 - area / 0.5, 0))
    expected = (distance / math.hypot(error, part)) ** 2 + 6 * math.log(error / ERROR)
    if distance > LARGEST_GAP or expected >= LARGEST_COST:
        assert found == math.inf
    else:
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-5)


def test_a_body_that_is_too_far_away_or_away_for_too_long_is_another() -> None:
    movement = at_rest(0, surface(0))
    assert movement.cost(SECOND // 30, surface(0.4)) < LARGEST_COST
    assert movement.cost(SECOND // 30, surface(0.7)) == math.inf
    assert movement.cost(SECOND // 2, surface(0.7)) < LARGEST_COST
    assert movement.cost(10 * SECOND, surface(0)) == math.inf
    # Less is certain of who was not seen.
    assert movement.cost(0, surface(0.1)) < at_rest(-SECOND // 2, surface(0)).cost(0, surface(0.1))


def test_the_velocity_settles_and_counts_less_if_little_is_visible() -> None:
    whole = hidden = at_rest(0, surface(0))
    for frame in range(1, 61):
        stamp = round(frame * SECOND / 30)
        whole = whole.seen(stamp, surface(frame / 30))
        hidden = hidden.seen(stamp, surface(frame / 30, area=0.05))
        settled = 1 - math.exp(-frame / 30 / SETTLING_SECONDS)
        np.testing.assert_allclose(whole.velocity, [settled, 0, 0], rtol=1e-6, atol=1e-9)
        assert hidden.velocity[0] < settled
    assert whole.area == pytest.approx(0.5)
    assert hidden.area == pytest.approx(0.5 * math.exp(-2 / AREA_SECONDS))
    assert whole.place[0] == pytest.approx(2)


def test_no_body_is_expected_to_fly() -> None:
    movement = at_rest(0, surface(0)).seen(SECOND, surface(100))
    assert float(np.linalg.norm(movement.velocity)) == pytest.approx(FASTEST)
    # A stamp that repeats changes nothing.
    assert movement.seen(SECOND, surface(0)) is movement
