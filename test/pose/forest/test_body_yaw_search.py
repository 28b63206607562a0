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

"""The search for the body yaw, against its definition and on synthetic people."""

import math

import numpy as np
import pytest

from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.forest import body_yaw_search, body_yaw_tracking
from lsc_pose_ros.pose.forest.body_yaw import body_yaws_around, with_body_yaw
from lsc_pose_ros.pose.forest.body_yaw_search import (
    agreement,
    agreement_on,
    peak_beside,
)
from lsc_pose_ros.pose.forest.body_yaw_tracking import follow_body_yaw
from lsc_pose_ros.pose.forest.forest import find_leaves
from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.pose.inference.density import VoteCloud
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.stages import joint_stages, run_stages
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.training.body_yaw_labels import body_yaws_of_people
from lsc_pose_ros.training.samples import LabelledPerson, labelled_people

BANDWIDTH = 0.07


def cast(positions: list[np.ndarray], weights: list[np.ndarray]) -> Votes:
    """Return votes at `positions`, shape (M, 3) for each joint."""
    start = np.concatenate([[0], np.cumsum([len(each) for each in positions])])
    x, y, z = np.ascontiguousarray(np.concatenate(positions).astype(np.float32).T)
    return Votes(start, VoteCloud(x, y, z, np.concatenate(weights).astype(np.float32)))


def random_votes(seed: int, counts: tuple[int, ...]) -> Votes:
    """Return `counts` votes in three clusters for each joint."""
    rng = np.random.default_rng(seed)
    positions = []
    for count in counts:
        centres = rng.normal(0, 0.3, (3, 3))
        positions.append(centres[rng.integers(0, 3, count)] + rng.normal(0, 0.04, (count, 3)))
    return cast(positions, [rng.random(count) for count in counts])


def density_twin(position: np.ndarray, votes: np.ndarray, weights: np.ndarray, h: float) -> float:
    squared = ((votes - position) ** 2).sum(axis=1)
    return float((weights * np.exp(-squared / h**2)).sum())


def mode_twin(votes: np.ndarray, weights: np.ndarray, h: float) -> np.ndarray:
    """Mean-shift from the vote with the largest density until convergence."""
    heights = [density_twin(vote, votes, weights, h) for vote in votes]
    position = votes[int(np.argmax(heights))]
    for _ in range(1000):
        pull = weights * np.exp(-((votes - position) ** 2).sum(axis=1) / h**2)
        position = (pull[:, None] * votes).sum(axis=0) / pull.sum()
    return position


def agreement_twin(votes: Votes, h: float) -> float:
    """The density at the best mode for a total weight of 1, summed over the joints."""
    total = 0.0
    for begin, end in zip(votes.start[:-1], votes.start[1:], strict=True):
        position = votes.position[begin:end].astype(float)
        weight = votes.weight[begin:end].astype(float)
        if weight.sum() > 0:
            mode = mode_twin(position, weight, h)
            total += density_twin(mode, position, weight / weight.sum(), h)
    return total


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('counts', [(1,), (40,), (80, 5, 0, 30), (0, 0)])
def test_agreement_is_the_sum_of_the_vote_fractions_at_the_best_modes(
    seed: int, counts: tuple[int, ...]
) -> None:
    votes = random_votes(seed, counts)
    for bandwidth in (BANDWIDTH, 0.2):
        expected = agreement_twin(votes, bandwidth)
        assert agreement(votes, bandwidth) == pytest.approx(expected, rel=2e-3)
    assert 0 <= agreement(votes, BANDWIDTH) <= sum(count > 0 for count in counts) * 1.0001


def test_votes_at_one_position_agree_fully_and_at_two_by_their_fraction() -> None:
    here, there = np.tile([0.1, 0.2, 2.0], (10, 1)), np.tile([0.1, 0.9, 2.0], (10, 1))
    ones = np.ones(10)
    assert agreement(cast([here], [3 * ones]), BANDWIDTH) == pytest.approx(1.0, rel=1e-4)
    assert agreement(cast([here, there], [ones, 9 * ones]), BANDWIDTH) == pytest.approx(
        2.0, rel=1e-4
    )
    both = np.concatenate([here, there])
    for fraction in (0.5, 0.8):
        weight = np.repeat([fraction, 1 - fraction], 10)
        assert agreement(cast([both], [weight]), BANDWIDTH) == pytest.approx(fraction, rel=1e-4)


def test_votes_without_weight_agree_on_nothing() -> None:
    rng = np.random.default_rng(0)
    votes = cast([rng.random((5, 3)), rng.random((1, 3))], [np.zeros(5), np.ones(1)])
    assert agreement(votes, BANDWIDTH) == pytest.approx(1.0, rel=1e-4)


def test_agreement_does_not_depend_on_translation_or_total_weight() -> None:
    votes = random_votes(7, (60, 30))
    moved = [
        Votes(votes.start, votes.cloud._replace(weight=np.float32(50) * votes.weight)),
        Votes(votes.start, votes.cloud._replace(z=votes.cloud.z + np.float32(2))),
    ]
    for each in moved:
        assert agreement(each, BANDWIDTH) == pytest.approx(agreement(votes, BANDWIDTH), rel=1e-3)


def peak_twin(values: np.ndarray, index: int) -> float:
    """The vertex of the parabola through the value and its two neighbours on the circle."""
    near = [values[(index + step) % len(values)] for step in (-1, 0, 1)]
    bend, slope, _ = np.round(np.polyfit([-1, 0, 1], near, 2), 12)
    if bend >= 0:  # it opens upwards: uphill as far as may be
        return 0.5 * (slope > 0) - 0.5 * (slope < 0)
    return min(0.5, max(-0.5, -slope / (2 * bend)))


@pytest.mark.parametrize('count', [3, 4, 8])
@pytest.mark.parametrize('seed', range(5))
def test_peak_is_that_of_a_parabola(count: int, seed: int) -> None:
    values = np.random.default_rng(seed).random(count)
    for index in range(count):
        found = peak_beside(values, index)
        assert -0.5 <= found <= 0.5
        assert found == pytest.approx(peak_twin(values, index), abs=1e-9)


@pytest.mark.parametrize('index', range(8))
@pytest.mark.parametrize('peak', [-0.5, -0.2, 0.0, 0.35, 0.5])
def test_peak_of_a_parabola_is_found_all_round_the_circle(index: int, peak: float) -> None:
    values = np.full(8, -100.0)
    for step in (-1, 0, 1):
        values[(index + step) % 8] = 3 - 0.4 * (step - peak) ** 2
    assert peak_beside(values, index) == pytest.approx(peak, abs=1e-9)


@pytest.mark.parametrize(
    ('values', 'expected'),
    [
        ([1.0], 0.0),
        ([3.0, 1.0], 0.0),
        ([2.0, 2.0, 2.0, 2.0], 0.0),
        ([2.0, 2.0, 1.0, 1.0], 0.5),  # as high as the next
        ([2.0, 1.0, 1.0, 2.0], -0.5),
        ([2.0, 3.0, 0.0, 1.0], 0.5),  # on a straight slope
        ([2.0, 2.5, 0.0, 1.0], 0.5),  # the peak lies farther off
        ([0.0, 2.0, 0.0, 1.0], 0.5),  # in a valley
        ([0.0, 1.0, 0.0, 2.0], -0.5),
        ([0.0, 2.0, 0.0, 2.0], 0.0),
    ],
)
def test_peaks_at_the_first_of_few_values(values: list[float], expected: float) -> None:
    assert peak_beside(np.array(values), 0) == expected


def apart(one: np.ndarray | float, two: np.ndarray | float) -> np.ndarray:
    """Return the angle between directions, degrees."""
    return np.degrees(np.abs(np.angle(np.exp(1j * (np.asarray(one) - two)))))


def find_body_yaw(model, points, quantised, scale):
    """Return the body yaw of a person of whom nothing is known."""
    return follow_body_yaw(model, points, quantised, scale, None, all_round=True).yaw


def person_of(person: LabelledPerson, which: np.ndarray | None = None) -> tuple:
    """Return the arguments of the search: points in metres, descriptors, rho_bar."""
    which = np.arange(len(person.points)) if which is None else which
    points = person.points[which] * np.float32(person.scale)
    return points, person.quantised[which], person.scale


@pytest.fixture(scope='module')
def strangers(all_round, body_yaw_model) -> list[LabelledPerson]:
    """People from all sides that the model was not trained on."""
    frames = synthetic_frames(all_round._replace(frames=150, seed=77, clip_length=1))
    return list(labelled_people(frames, body_yaw_model.joints, body_yaw_model.settings))


@pytest.fixture(scope='module')
def found(body_yaw_model, strangers) -> np.ndarray:
    """The body yaw that the search finds for each of them."""
    return np.array([find_body_yaw(body_yaw_model, *person_of(each)) for each in strangers])


def body_yaws(model: Model, count: int) -> Model:
    """Return a model with `count` body yaws."""
    return model._replace(settings=model.settings._replace(body_yaws=count))


def votes_twin(model: Model, leaves: np.ndarray, points: np.ndarray, scale: float) -> Votes:
    """The heaviest votes for each joint, point by point and tree by tree."""
    votes = model.forest.joint_votes
    cast_for: list[list[tuple[float, np.ndarray]]] = [[] for _ in model.joints]
    for point, in_trees in zip(points, leaves, strict=True):
        for leaf in in_trees:
            for n in range(votes.start[leaf], votes.start[leaf + 1]):
                vote = float(votes.weight[n]), point + scale * votes.offset[n]
                cast_for[votes.target[n]].append(vote)
    heaviest = [
        sorted(each, key=lambda vote: -vote[0])[: model.settings.heaviest_votes]
        for each in cast_for
    ]
    return cast(
        [np.array([position for _, position in each]).reshape(-1, 3) for each in heaviest],
        [np.array([weight for weight, _ in each]) for each in heaviest],
    )


@pytest.mark.parametrize('body_yaw', [-2.0, 0.0, 3.1])
def test_agreement_is_that_of_the_votes_for_the_given_body_yaw(
    body_yaw: float, body_yaw_model: Model, strangers: list[LabelledPerson]
) -> None:
    for person in strangers[:3]:
        points, quantised, scale = person_of(person)
        leaves = find_leaves(body_yaw_model.forest, with_body_yaw(quantised, body_yaw))
        votes = votes_twin(body_yaw_model, leaves, points, scale)
        expected = agreement_twin(votes, body_yaw_model.settings.joint_bandwidth)
        told = agreement_on(body_yaw_model, points, quantised, scale, body_yaw)
        assert told == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize('count', [1, 2, 5, 8])
def test_few_points_choose_the_body_yaw_with_the_largest_agreement(
    count: int, body_yaw_model: Model, strangers: list[LabelledPerson]
) -> None:
    model, directions = body_yaws(body_yaw_model, count), body_yaws_around(count)
    for person in strangers[:20]:
        asked = person_of(person, np.arange(0, len(person.points), 5))
        assert len(asked[0]) == 30
        agreed = np.array([agreement_on(model, *asked, body_yaw) for body_yaw in directions])
        best = int(np.argmax(agreed))
        expected = directions[best] + peak_twin(agreed, best) * 2 * math.pi / count
        assert apart(find_body_yaw(model, *asked), expected) < 0.01


def test_all_points_choose_among_the_best_body_yaws_of_a_few(
    body_yaw_model: Model, strangers: list[LabelledPerson], found: np.ndarray
) -> None:
    directions = body_yaws_around(8)
    best = 0
    for person, body_yaw in zip(strangers, found, strict=True):
        agreed = [agreement_on(body_yaw_model, *person_of(person), each) for each in directions]
        distance = apart(body_yaw, directions)
        chosen = int(np.argmin(distance))
        assert distance[chosen] <= 22.5 + 1e-6
        best += agreed[chosen] == max(agreed) or np.sort(distance)[1] < 22.5 + 1e-6
    assert best > 0.85 * len(strangers)


def test_body_yaw_of_unknown_people_is_found(
    body_yaw_model: Model, strangers: list[LabelledPerson], found: np.ndarray
) -> None:
    joints = np.stack([person.joints for person in strangers])
    off = apart(found, body_yaws_of_people(joints, body_yaw_model.joints))
    # The trees differ between processors. With other seeds of the training, 81 % to 87 % and 75 %
    # to 77 % were measured, the median at 20 degrees. Chance gives 50 %, 25 % and 90 degrees.
    assert (off < 90).mean() > 0.7
    assert (off < 45).mean() > 0.6
    assert np.median(off) < 30


def test_thirty_points_find_the_body_yaw_of_most_people(
    body_yaw_model: Model, strangers: list[LabelledPerson]
) -> None:
    joints = np.stack([person.joints for person in strangers])
    ground_truth = body_yaws_of_people(joints, body_yaw_model.joints)
    found = [
        find_body_yaw(body_yaw_model, *person_of(each, np.arange(0, len(each.points), 5)))
        for each in strangers
    ]
    off = apart(found, ground_truth)
    # 64 % to 71 % and 59 % were measured; chance gives 50 % and 25 %.
    assert (off < 90).mean() > 0.55
    assert (off < 45).mean() > 0.4


def test_order_of_the_body_yaws_does_not_matter(
    body_yaw_model: Model,
    strangers: list[LabelledPerson],
    found: np.ndarray,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for turned in (3, 6):
        for module in (body_yaw_search, body_yaw_tracking):
            monkeypatch.setattr(
                module,
                'body_yaws_around',
                lambda count, turned=turned: np.roll(body_yaws_around(count), turned),
            )
        again = [find_body_yaw(body_yaw_model, *person_of(each)) for each in strangers[:50]]
        assert apart(again, found[:50]).max() < 0.01


def test_another_set_of_body_yaws_gives_the_same_result_for_most_people(
    body_yaw_model: Model, strangers: list[LabelledPerson], found: np.ndarray
) -> None:
    model = body_yaws(body_yaw_model, 9)
    again = [find_body_yaw(model, *person_of(each)) for each in strangers]
    assert (apart(again, found) < 45).mean() > 0.7  # 83 % and more; chance gives 25 %


def test_order_of_the_points_does_not_matter_much(
    body_yaw_model: Model, strangers: list[LabelledPerson], found: np.ndarray
) -> None:
    rng = np.random.default_rng(0)
    again = [
        find_body_yaw(body_yaw_model, *person_of(each, rng.permutation(len(each.points))))
        for each in strangers
    ]
    assert (apart(again, found) < 45).mean() > 0.7  # 83 % and more; chance gives 25 %


def test_leaves_are_those_of_the_descriptors_with_the_body_yaw_if_the_trees_split_by_it(
    small_model: Model, people: list, body_yaw_model: Model, strangers: list[LabelledPerson]
) -> None:
    known = list(labelled_people(people[:5], small_model.joints, small_model.settings))
    for model, persons in ((small_model, known), (body_yaw_model, strangers[:5])):
        for person in persons:
            points, quantised, scale = person_of(person)
            body = BodyEstimate.from_descriptors(points, quantised, scale)
            assert run_stages(joint_stages(model), body)
            if model is body_yaw_model:
                body_yaw = find_body_yaw(model, points, quantised, scale)
                quantised = with_body_yaw(quantised, body_yaw)
            np.testing.assert_array_equal(body.leaves, find_leaves(model.forest, quantised))
