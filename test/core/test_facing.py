"""Where a person faces, from the evidence in leaves, written from its definition once more."""

import math

import numpy as np
import pytest

from lsc_pose_ros.core.facing import (
    FACING_SIZE,
    SECTORS,
    STEP,
    FacingForest,
    _sum_evidence,
    are_witnesses,
    facing_levels,
    facing_of,
    find_facing,
    sector_centres,
    sector_of,
    turned_round,
    with_facing,
)
from lsc_pose_ros.core.forest import find_leaves

FEATURES = 12


def random_forest(rng: np.random.Generator, trees: int = 3, depth: int = 4) -> FacingForest:
    """Return trees of which every leaf is as deep, nodes level by level."""
    splits, leaves = 2**depth - 1, 2**depth
    size = splits + leaves
    children = 1 + 2 * np.arange(splits)
    feature = rng.integers(0, FEATURES, (trees, size))
    feature[:, splits:] = -1
    left = [[*(t * size + children), *(t * leaves + np.arange(leaves))] for t in range(trees)]
    return FacingForest(
        (size * np.arange(trees)).astype(np.int32),
        feature.ravel().astype(np.int16),
        rng.integers(0, 256, trees * size).astype(np.uint8),
        np.array(left, np.int32).ravel(),
        rng.integers(-127, 128, (trees * leaves, SECTORS)).astype(np.int8),
    )


def single_leaf(evidence: list[int]) -> FacingForest:
    """Return one tree in which every point says the same."""
    return FacingForest(
        np.zeros(1, np.int32),
        np.array([-1], np.int16),
        np.zeros(1, np.uint8),
        np.zeros(1, np.int32),
        np.array([evidence], np.int8),
    )


def evidence_twin(forest: FacingForest, leaves: np.ndarray) -> list[int]:
    return [sum(int(forest.evidence[leaf, s]) for leaf in leaves.flat) for s in range(SECTORS)]


def facing_twin(forest: FacingForest, levels: np.ndarray) -> float:
    """The mean direction under p_s ~ exp(20 mean of log(p(s | leaf) / p(s)))."""
    leaves = find_leaves(forest, levels)
    mean = np.array(evidence_twin(forest, leaves)) * STEP / leaves.size
    shares = [math.exp(20 * (each - mean.max())) for each in mean]
    middles = [-math.pi + (s + 0.5) * 2 * math.pi / SECTORS for s in range(SECTORS)]
    along = sum(share * math.cos(middle) for share, middle in zip(shares, middles, strict=True))
    aside = sum(share * math.sin(middle) for share, middle in zip(shares, middles, strict=True))
    return math.atan2(aside, along)


def apart(one: float, two: float) -> float:
    """Return how far two directions are from each other, radians."""
    return abs(math.remainder(one - two, 2 * math.pi))


@pytest.mark.parametrize('seed', range(4))
@pytest.mark.parametrize('points', [1, 7, 180])
def test_the_leaves_evidence_adds_up_to_a_direction(seed: int, points: int) -> None:
    rng = np.random.default_rng(seed)
    forest = random_forest(rng)
    levels = rng.integers(0, 256, (points, FEATURES)).astype(np.uint8)
    leaves = find_leaves(forest, levels)
    assert _sum_evidence(forest, leaves).tolist() == evidence_twin(forest, leaves)
    assert apart(find_facing(forest, levels), facing_twin(forest, levels)) < 1e-9


def test_evidence_of_no_leaves_is_none() -> None:
    forest = random_forest(np.random.default_rng(0))
    assert _sum_evidence(forest, np.empty((0, 3), np.int32)).tolist() == [0] * SECTORS


@pytest.mark.parametrize('sector', range(SECTORS))
@pytest.mark.parametrize('points', [1, 100])
def test_points_that_are_sure_of_a_sector_give_its_middle(sector: int, points: int) -> None:
    forest = single_leaf([33 if s == sector else -20 for s in range(SECTORS)])
    found = find_facing(forest, np.zeros((points, FEATURES), np.uint8))
    assert apart(found, sector_centres()[sector]) < 1e-6


@pytest.mark.parametrize('sector', range(SECTORS))
def test_between_two_sectors_lies_their_border_across_the_back_too(sector: int) -> None:
    both = {sector, (sector + 1) % SECTORS}
    forest = single_leaf([30 if s in both else -30 for s in range(SECTORS)])
    found = find_facing(forest, np.zeros((5, FEATURES), np.uint8))
    assert apart(found, sector_centres()[sector] + math.pi / SECTORS) < 1e-6


def test_a_turned_person_is_found_turned() -> None:
    rng = np.random.default_rng(1)
    forest = random_forest(rng)
    levels = rng.integers(0, 256, (40, FEATURES)).astype(np.uint8)
    turned = forest._replace(evidence=np.roll(forest.evidence, 1, axis=1))
    step = 2 * math.pi / SECTORS
    assert apart(find_facing(turned, levels), find_facing(forest, levels) + step) < 1e-9


def test_the_same_points_again_make_it_no_surer() -> None:
    rng = np.random.default_rng(2)
    forest = random_forest(rng)
    levels = rng.integers(0, 256, (3, FEATURES)).astype(np.uint8)
    again = np.repeat(levels, 50, axis=0)
    assert apart(find_facing(forest, again), find_facing(forest, levels)) < 1e-9


@pytest.mark.parametrize('points', [0, 1, 30])
@pytest.mark.parametrize('level', [0, 127, -127])
def test_even_evidence_gives_some_direction(points: int, level: int) -> None:
    found = find_facing(single_leaf([level] * SECTORS), np.zeros((points, FEATURES), np.uint8))
    assert -math.pi <= found <= math.pi


def test_sectors_go_round_the_circle() -> None:
    centres = sector_centres()
    half = math.pi / SECTORS
    every = np.arange(SECTORS)
    np.testing.assert_allclose(np.diff(centres), 2 * half)
    np.testing.assert_array_equal(sector_of(centres), every)
    for rounds in (-1, 1, 3):
        np.testing.assert_array_equal(sector_of(centres + 2 * np.pi * rounds), every)
    for shift in (-0.99 * half, 0.99 * half):
        np.testing.assert_array_equal(sector_of(centres + shift), every)
    np.testing.assert_array_equal(sector_of(centres + 1.01 * half), (every + 1) % SECTORS)
    assert sector_of(np.array([-np.pi, np.pi])).tolist() == [0, 0]
    assert sector_of(np.zeros((2, 3))).shape == (2, 3)


@pytest.mark.parametrize(
    ('across', 'degrees'),
    [
        ((0.4, 0, 0), 0),  # the left shoulder is at image right: towards the camera
        ((0, 0, 0.4), 90),  # it is farther away: to image right
        ((0, 0, -0.4), -90),
        ((-0.4, 0, 0), 180),
        ((3, -7, 3), 45),  # how high a shoulder is does not count, nor how wide they are
        ((-1, 2, -1), -135),
    ],
)
def test_facing_by_the_line_from_right_to_left(
    across: tuple[float, float, float], degrees: float
) -> None:
    assert apart(float(facing_of(np.array(across))), math.radians(degrees)) < 1e-9


def test_facing_of_many_and_of_what_is_not_known() -> None:
    lines = np.zeros((2, 5, 3), np.float32)
    lines[..., 0] = 1
    lines[1, 3, 2] = np.nan
    found = facing_of(lines)
    assert found.shape == (2, 5)
    assert np.isnan(found[1, 3])
    assert np.isnan(found).sum() == 1


def test_levels_tell_every_direction() -> None:
    angles = np.linspace(-np.pi, np.pi, 721)
    levels = facing_levels(angles)
    assert levels.dtype == np.uint8
    assert levels.shape == (721, FACING_SIZE)
    told = np.arctan2(*(levels.T[::-1] - 127.5))
    assert np.abs(np.angle(np.exp(1j * (told - angles)))).max() < np.radians(0.5)
    np.testing.assert_allclose(levels[0], levels[-1], atol=1)
    np.testing.assert_array_equal(facing_levels(angles[100:110] + 2 * np.pi), levels[100:110])


@pytest.mark.parametrize('points', [0, 1, 9])
def test_facing_joins_every_descriptor(points: int) -> None:
    levels = np.random.default_rng(points).integers(0, 256, (points, FEATURES)).astype(np.uint8)
    joined = with_facing(levels, -2.0)
    assert joined.dtype == np.uint8
    assert joined.flags.c_contiguous
    np.testing.assert_array_equal(joined[:, :FEATURES], levels)
    cosine, sine = 127.5 + 127 * math.cos(-2.0), 127.5 + 127 * math.sin(-2.0)
    assert joined[:, FEATURES:].tolist() == [[round(cosine), round(sine)]] * points


def test_legs_and_head_are_asked_and_trunk_and_arms_are_not():
    heights = np.array([0.9, 0.6, 0.5, 0.1, -0.1, -0.9, -1.1])  # above the middle, rho_bars
    points = np.zeros((7, 3), np.float32)
    points[:, 1] = 2.0 - 0.5 * heights  # y is down
    asked = are_witnesses(points, 0.5)
    assert asked.tolist() == [True, True, False, False, True, True, True]


def test_where_all_points_are_at_one_height_all_are_asked():
    assert are_witnesses(np.ones((4, 3), np.float32), 0.5).all()


@pytest.mark.parametrize('degrees', [-180.0, -120.0, -90.0, -10.0, 0.0, 45.0, 90.0, 135.0])
def test_who_is_turned_round_has_the_same_outline_and_shows_the_other_side(degrees):
    facing = np.radians(degrees)
    other = turned_round(facing)
    assert np.sin(other) == pytest.approx(np.sin(facing), abs=1e-9)
    assert np.cos(other) == pytest.approx(-np.cos(facing), abs=1e-9)
