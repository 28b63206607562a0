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

"""How many frames must be missing, by their stamps; streams are simulated."""

import numpy as np
import pytest

from lsc_pose_ros.synchronization.frame_loss import FrameLoss

PERIOD = 33_333_333
START = 10**18
MILLISECOND = 1_000_000


def at_even_pace(numbers: np.ndarray, jitter: float, seed: int) -> np.ndarray:
    """Stamps of frames with `numbers`, off an even pace by normal `jitter` in ms; increasing."""
    random = np.random.default_rng(seed)
    noise = random.normal(0, jitter * MILLISECOND, len(numbers))
    stamps = START + numbers * PERIOD + noise.astype(np.int64)
    newest = np.maximum.accumulate(stamps)
    return newest[np.concatenate(([True], np.diff(newest) > 0))]


def missing(stamps: np.ndarray) -> int:
    """What is counted; it never decreases."""
    loss = FrameLoss()
    counts = []
    for stamp in stamps:
        loss.add(int(stamp))
        counts.append(loss.missing)
    assert counts == sorted(counts)
    return counts[-1]


def losing(share: float, seed: int, frames: int = 3000) -> tuple[np.ndarray, int]:
    """The numbers of the frames that come, and how many do not."""
    came = np.random.default_rng(seed + 100).random(frames) >= share
    came[[0, -1]] = True
    return np.flatnonzero(came), int((~came).sum())


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('jitter', [0, 1, 3, 5, 8])
def test_jitter_makes_nothing_missing(jitter: float, seed: int) -> None:
    assert missing(at_even_pace(np.arange(5000), jitter, seed)) <= 10


def test_uneven_pace_makes_nothing_missing() -> None:
    steps = np.random.default_rng(0).uniform(0.75, 1.25, 3000) * PERIOD
    assert missing(START + np.cumsum(steps).astype(np.int64)) == 0


def test_stamps_of_arrival_in_bursts_make_nothing_missing() -> None:
    steps = np.tile([MILLISECOND, 2 * PERIOD - MILLISECOND], 1000)
    assert missing(START + np.cumsum(steps)) == 0


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('share', [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.6])
def test_losses_are_found(share: float, seed: int) -> None:
    numbers, lost = losing(share, seed)
    assert missing(at_even_pace(numbers, 0, seed)) == pytest.approx(lost, rel=0.2)


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize(
    ('jitter', 'share', 'least', 'most'),
    [
        (1, 0.05, 0.9, 1.1),
        (1, 0.5, 0.85, 1.05),
        (3, 0.05, 0.7, 1.1),
        (3, 0.2, 0.8, 1.1),
        (5, 0.1, 0.6, 1.1),
        (5, 0.35, 0.7, 1.1),
        (8, 0.1, 0.4, 1.1),  # steps of one and of two periods overlap
        (8, 0.35, 0.5, 1.1),
    ],
)
def test_losses_are_found_in_spite_of_jitter(
    *, jitter: float, share: float, least: float, most: float, seed: int
) -> None:
    numbers, lost = losing(share, seed)
    assert least * lost <= missing(at_even_pace(numbers, jitter, seed)) <= most * lost


def test_single_loss_is_found() -> None:
    numbers = np.delete(np.arange(200), 90)
    assert missing(at_even_pace(numbers, 0.5, 0)) == 1


@pytest.mark.parametrize('offset', [0, 7])
@pytest.mark.parametrize('jitter', [0, 2, 5, 8])
def test_rate_that_changes_makes_hardly_anything_missing(jitter: float, offset: int) -> None:
    steps = np.repeat([1, 2, 1, 3], [203 + offset, 207, 211, 113])
    # Of 300 slower frames, what has come right after a change is in doubt.
    assert missing(at_even_pace(np.cumsum(steps), jitter, 0)) <= 20


def test_losses_are_found_after_the_rate_has_changed() -> None:
    numbers, lost = losing(0.2, 0, frames=1000)
    steps = np.concatenate((np.ones(300, int), 2 * np.diff(numbers)))
    assert missing(at_even_pace(np.cumsum(steps), 1, 0)) == pytest.approx(lost, rel=0.15)


def test_pause_makes_nothing_missing() -> None:
    steps = np.full(300, PERIOD)
    steps[[70, 150]] = 3_000_000_000
    assert missing(START + np.cumsum(steps)) == 0


def test_after_a_restart_only_new_stamps_count() -> None:
    loss = FrameLoss()
    for number in range(35):
        loss.add(START + number * PERIOD)
    loss.restart()
    for number in range(100):
        loss.add(START // 2 + 2 * number * PERIOD)
    assert loss.missing == 0


def test_losses_at_an_uneven_pace_are_not_counted_twice() -> None:
    """The pace varies by 3 % with a period of 80 frames; each 25th frame is lost.

    A block of short steps compensates for a block of long ones: without that, 154 are counted.
    """
    numbers = np.arange(3000)
    steps = PERIOD * (1 + 0.03 * np.sin(2 * np.pi * numbers / 80))
    came = np.ones(3000, bool)
    came[15::25] = False
    stamps = START + np.cumsum(steps).astype(np.int64)
    assert missing(stamps[came]) == pytest.approx((~came).sum(), rel=0.1)
