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

"""The body yaw over frames, against a plain twin: a turning person, ambiguous frames, a gap.

The agreements of the votes are given, so that the frames are known; those of real votes are tested
in `test_body_yaw_search.py`.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from lsc_pose_ros.pose.forest import body_yaw_search
from lsc_pose_ros.pose.forest.body_yaw import body_yaws_around
from lsc_pose_ros.pose.forest.body_yaw_tracking import (
    LARGEST_DOUBT,
    LEAST_AGREEMENT,
    LEAST_LEAD,
    TURN_PENALTY,
    BodyYawBelief,
    follow_body_yaw,
)

COUNT = 8
STEP = 2 * math.pi / COUNT
POINTS = np.zeros((100, 3), np.float32)
QUANTISED = np.zeros((100, 4), np.uint8)


class Frames:
    """Frames with given agreements on each body yaw.

    Attributes:
        table: of the present frame, shape (COUNT,).
        tried: the body yaws that were tried in it, as indices.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.table = np.zeros(COUNT)
        self.tried: list[int] = []
        self._model = SimpleNamespace(settings=SimpleNamespace(body_yaws=COUNT))
        monkeypatch.setattr(body_yaw_search, 'agreement_on', self._agreement_on)

    def _agreement_on(self, _model, _points, _quantised, _scale, body_yaw: float) -> float:
        index = int(np.argmin(apart(body_yaws_around(COUNT), body_yaw)))
        self.tried.append(index)
        return float(self.table[index])

    def follow(
        self, table: np.ndarray, before: BodyYawBelief | None, *, all_round: bool
    ) -> BodyYawBelief:
        self.table, self.tried = table, []
        return follow_body_yaw(self._model, POINTS, QUANTISED, 0.3, before, all_round=all_round)


@pytest.fixture
def frames(monkeypatch: pytest.MonkeyPatch) -> Frames:
    return Frames(monkeypatch)


def apart(one: np.ndarray | float, two: np.ndarray | float) -> np.ndarray:
    """Return the angle between directions, radians."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(one) - two))))


def facing(yaw: float, back: float = 0.85) -> np.ndarray:
    """Return agreements of a person who faces `yaw`; those from behind are nearly as high."""
    off = apart(body_yaws_around(COUNT), yaw)
    return 6 + 4 * np.maximum(np.cos(off), back * np.cos(math.pi - off))


class Twin:
    """The rules in plain words, number by number."""

    def __init__(self) -> None:
        self.belief: list[float] | None = None
        self.agreement = [0.0] * COUNT
        self.best_agreement = 0.0
        self.doubtful = False

    def follow(self, table: np.ndarray, *, all_round: bool) -> float:
        """Return the body yaw after a frame."""
        if self.belief is None:
            rough, belief = list(table), list(table)
        else:
            carried = self._carried(self.belief)
            last = self.belief.index(max(self.belief))
            rough = self._tried(table, last, carried, all_round=all_round)
            belief = [r + c for r, c in zip(rough, carried, strict=True)]
        best = belief.index(max(belief))
        self.belief = [max(each - belief[best], -LARGEST_DOUBT) for each in belief]
        self.best_agreement = rough[best]
        self.agreement = [each / max(rough) for each in rough]
        alone = rough.index(max(rough))
        beside = {(best + step) % COUNT for step in (-1, 0, 1)}
        rivals = [self.belief[k] for k in range(COUNT) if k not in beside]
        self.doubtful = alone not in beside or max(rivals) > -LEAST_LEAD
        return float(body_yaws_around(COUNT)[best]) + STEP * self._peak(rough, best)

    def _carried(self, belief: list[float]) -> list[float]:
        """The best path to each body yaw: turning costs, and no path is hopeless."""
        carried = []
        for k in range(COUNT):
            paths = []
            for j in range(COUNT):
                turns = min((k - j) % COUNT, (j - k) % COUNT)
                paths.append(belief[j] - TURN_PENALTY * turns)
            carried.append(max(paths))
        return [max(each - max(carried), -LARGEST_DOUBT) for each in carried]

    def _tried(
        self, table: np.ndarray, last: int, carried: list[float], *, all_round: bool
    ) -> list[float]:
        """What is known of the agreements: those beside the last body yaw, or all of them."""
        beside = [(last + step) % COUNT for step in (-1, 0, 1)]
        highest = float(max(table[k] for k in beside))
        rough = [
            float(table[k]) if k in beside else highest * self.agreement[k] for k in range(COUNT)
        ]
        best = max(range(COUNT), key=lambda k: rough[k] + carried[k])
        if all_round or self.doubtful or rough[best] < LEAST_AGREEMENT * self.best_agreement:
            return [float(each) for each in table]
        return rough

    def _peak(self, values: list[float], best: int) -> float:
        before, here, after = (values[(best + step) % COUNT] for step in (-1, 0, 1))
        bend = before - 2 * here + after
        if bend >= 0:
            return 0.5 * (after > before) - 0.5 * (after < before)
        return min(0.5, max(-0.5, 0.5 * (before - after) / bend))


def run(
    frames: Frames, tables: list[np.ndarray], gaps: frozenset[int] = frozenset()
) -> np.ndarray:
    """Return the body yaw of each frame, which is that of the twin; all are tried now and then."""
    belief, twin, found = None, Twin(), []
    for n, table in enumerate(tables):
        if n in gaps:
            belief, twin = None, Twin()
        all_round = n % 15 == 14
        belief = frames.follow(table, belief, all_round=all_round)
        expected = twin.follow(table, all_round=all_round)
        assert apart(belief.yaw, expected) < 1e-9
        np.testing.assert_allclose(belief.belief, twin.belief, atol=1e-9)
        np.testing.assert_allclose(belief.agreement, twin.agreement, atol=1e-9)
        assert belief.best_agreement == pytest.approx(twin.best_agreement)
        assert belief.doubtful == twin.doubtful
        found.append(belief.yaw)
    return np.array(found)


@pytest.mark.parametrize('seed', range(5))
def test_any_frames_are_followed_as_by_the_twin(frames: Frames, seed: int) -> None:
    rng = np.random.default_rng(seed)
    yaws = np.cumsum(rng.normal(0, 0.3, 200))
    noise = rng.normal(0, 1.5, (200, COUNT))
    run(
        frames,
        [facing(yaw) + each for yaw, each in zip(yaws, noise, strict=True)],
        frozenset({50, 51, 120}),
    )


@pytest.mark.parametrize('speed', [-2.5, 1.0, 4.0])  # radians per second
def test_a_person_who_turns_is_followed_all_round(frames: Frames, speed: float) -> None:
    yaws = speed * np.arange(120) / 30
    assert abs(yaws[-1]) > math.pi
    found = run(frames, [facing(yaw) for yaw in yaws])
    assert (apart(found, yaws) < STEP).all()


def test_ambiguous_frames_do_not_turn_a_person_round(frames: Frames) -> None:
    """In three frames the back agrees better, by as much as makes a frame alone say so."""
    tables = [facing(0.3)] * 20 + [facing(0.3 + math.pi)] * 3 + [facing(0.3)] * 20
    alone = [frames.follow(table, None, all_round=True).yaw for table in tables]
    assert (apart(np.array(alone), 0.3) > 2).sum() == 3
    assert (apart(run(frames, tables), 0.3) < STEP).all()


def test_frames_that_agree_overrule_the_past(frames: Frames) -> None:
    """The back agrees a little better, which shows when all are tried, and is then believed."""
    front, back = facing(0.3), facing(0.3 + math.pi)
    assert 0 < back.max() - front[np.argmax(back)] < TURN_PENALTY * COUNT / 4
    found = run(frames, [front] * 20 + [back] * 30)
    assert (apart(found[-10:], 0.3 + math.pi) < STEP).all()


def test_a_person_who_was_first_seen_turned_round_does_not_stay_so(frames: Frames) -> None:
    found = run(frames, [facing(0.3 + math.pi)] + [facing(0.3)] * 40)
    assert apart(found[0], 0.3 + math.pi) < STEP
    assert (apart(found[-20:], 0.3) < STEP).all()


def test_a_person_whose_back_agreed_better_at_first_does_not_stay_turned_round(
    frames: Frames,
) -> None:
    """The front agrees a little better in most frames: too little for a single one to decide."""
    front, back = facing(0.3, back=0.98), facing(0.3 + math.pi, back=0.98)
    assert 0 < front.max() - back[np.argmax(front)] < LEAST_LEAD / 2
    found = run(frames, [back, back] + [front] * 30)
    assert apart(found[0], 0.3 + math.pi) < STEP
    assert (apart(found[-10:], 0.3) < STEP).all()


def test_all_body_yaws_are_tried_until_one_leads(frames: Frames) -> None:
    table, belief, frames_until_decided = facing(0.3, back=0.9), None, 0
    while belief is None or belief.doubtful:
        belief = frames.follow(table, belief, all_round=False)
        assert set(frames.tried) == set(range(COUNT))
        frames_until_decided += 1
    # The lead grows by the same difference in each frame, until it is large enough.
    away = apart(body_yaws_around(COUNT), 0.3) > 1.5 * STEP
    lead = table.max() - table[away].max()
    assert frames_until_decided == math.ceil(LEAST_LEAD / lead) > 1
    frames.follow(table, belief, all_round=False)
    assert len(set(frames.tried)) == 3


def test_all_body_yaws_are_tried_while_a_frame_alone_says_another(frames: Frames) -> None:
    belief = None
    for _ in range(5):
        belief = frames.follow(facing(0.3), belief, all_round=True)
    assert not belief.doubtful
    belief = frames.follow(facing(0.3 + math.pi), belief, all_round=True)
    assert belief.doubtful
    belief = frames.follow(facing(0.3), belief, all_round=False)
    assert set(frames.tried) == set(range(COUNT))
    assert not belief.doubtful
    frames.follow(facing(0.3), belief, all_round=False)
    assert len(set(frames.tried)) == 3


def test_after_a_gap_the_past_does_not_count(frames: Frames) -> None:
    tables = [facing(0.3)] * 20 + [facing(0.3 + math.pi)] * 3
    found = run(frames, tables, frozenset({20}))
    assert (apart(found[20:], 0.3 + math.pi) < STEP).all()
    assert (apart(found[:20], 0.3) < STEP).all()


def test_only_body_yaws_beside_the_last_are_tried_unless_the_agreement_drops(
    frames: Frames,
) -> None:
    belief = frames.follow(facing(0.0), None, all_round=True)
    assert set(frames.tried) == set(range(COUNT))
    while belief.doubtful:
        belief = frames.follow(facing(0.0), belief, all_round=True)
    at = int(np.argmax(belief.belief))
    beside = {(at + step) % COUNT for step in (-1, 0, 1)}
    belief = frames.follow(facing(0.0), belief, all_round=False)
    assert set(frames.tried) == beside
    frames.follow(facing(0.0), belief, all_round=True)
    assert set(frames.tried) == set(range(COUNT))
    frames.follow(facing(0.0) * (LEAST_AGREEMENT + 0.01), belief, all_round=False)
    assert set(frames.tried) == beside
    frames.follow(facing(0.0) * (LEAST_AGREEMENT - 0.01), belief, all_round=False)
    assert set(frames.tried) == set(range(COUNT))


def test_a_belief_in_another_number_of_body_yaws_does_not_count(frames: Frames) -> None:
    other = BodyYawBelief(0.0, np.zeros(COUNT + 1), np.ones(COUNT + 1), 5.0)
    found = frames.follow(facing(1.0), other, all_round=False)
    expected = frames.follow(facing(1.0), None, all_round=True)
    assert found.yaw == expected.yaw
