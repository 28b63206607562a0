"""Teaching where people face: from skeletons, from made-up samples, and from people all round."""

import math

import numpy as np
import pytest

from lsc_pose_ros.core.estimator import Estimator
from lsc_pose_ros.core.facing import SECTORS, STEP, find_facing, sector_centres, sector_of
from lsc_pose_ros.core.joints import numbers_of
from lsc_pose_ros.data.synthetic.generator import synthetic_frames
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.learning.evaluate import evaluate, summarise
from lsc_pose_ros.learning.facing import (
    FacingSettings,
    leaf_evidence,
    people_facing,
    sector_evidence,
    teach_facing,
)
from lsc_pose_ros.learning.growth import GrowthSettings, Tree, join_trees
from lsc_pose_ros.learning.samples import Samples, labelled_people
from lsc_pose_ros.learning.train import train

NAMES = ['head', 'l_shoulder', 'l_hip', 'r_shoulder', 'r_hip']
NUMBERS = numbers_of(NAMES)


def skeleton(degrees, lean=0.0):
    """Return NAMES of somebody who faces there and stands 3 m away; hips are `lean` ahead."""
    angle, ahead = np.radians(degrees), np.radians(degrees + lean)
    middle = np.array([0.3, 0.0, 3.0])
    shoulders = 0.2 * np.array([np.cos(angle), 0.1, np.sin(angle)])
    hips = 0.1 * np.array([np.cos(ahead), -0.1, np.sin(ahead)])
    head, up, down = (middle + np.array([0, height, 0]) for height in (-0.6, -0.3, 0.3))
    return np.array([head, up + shoulders, down + hips, up - shoulders, down - hips], np.float32)


def apart(one, two):
    """Return how far directions are from each other, radians."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(one) - two))))


def test_where_skeletons_face():
    degrees = np.array([0, 30, 90, -90, 135, 179, 180, -179, -60])
    joints = np.stack([skeleton(each) for each in degrees])
    found = people_facing(joints, NUMBERS)
    assert found.shape == degrees.shape
    assert apart(found, np.radians(degrees)).max() < 1e-5
    other_unit = people_facing(joints / np.float32(0.7), NUMBERS)
    assert apart(found, other_unit).max() < 1e-5


@pytest.mark.parametrize('degrees', [0, 100, 170, -150])
def test_shoulders_and_hips_count_alike(degrees):
    found = people_facing(skeleton(degrees, lean=40.0)[None], NUMBERS)
    assert apart(found, np.radians(degrees + 20.0))[0] < 0.01


@pytest.mark.parametrize('joint', range(len(NAMES)))
def test_who_lacks_a_shoulder_or_a_hip_faces_nowhere(joint):
    joints = np.stack([skeleton(0), skeleton(90)])
    joints[0, joint] = np.nan
    found = people_facing(joints, NUMBERS)
    assert np.isnan(found[0]) == (NAMES[joint] != 'head')
    assert np.isfinite(found[1])


def test_missing_joints_are_named(people, training):
    few = numbers_of(['head', 'l_shoulder', 'l_hip', 'r_hip'])
    with pytest.raises(InputError, match=r'also learn r_shoulder, or leave out --facing'):
        people_facing(np.zeros((2, 4, 3), np.float32), few)
    none = numbers_of(['head', 'l_knee'])
    before = iter(people)
    with pytest.raises(InputError, match=r'learn l_shoulder, r_shoulder, l_hip, r_hip, or'):
        train(before, training._replace(joints=none, facing=True), {})
    assert next(before) is people[0]  # that it cannot be is said before all is read


def test_sectors_as_evidence():
    sector = np.array([3, -1, 0, 7, 7, -1, 3])
    evidence = sector_evidence(sector)
    expected = np.zeros((len(sector), SECTORS))
    for sample, each in enumerate(sector):
        if each >= 0:
            expected[sample, each] = 1
    found = np.zeros_like(expected)
    for sample in range(len(sector)):
        some = slice(evidence.start[sample], evidence.start[sample + 1])
        found[sample, evidence.joint[some]] = evidence.value[some, 0]
    np.testing.assert_array_equal(found, expected)
    assert evidence.nothing.shape == (SECTORS, 1)
    assert not evidence.nothing.any()


def leaf_tree(rng, sizes):
    """Return a tree of which only the leaves matter, with so many samples each."""
    order = rng.permutation(sum(sizes)).astype(np.int32)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    nothing = np.zeros(0)
    return Tree(nothing, nothing, nothing, order, starts)


def leaf_evidence_twin(tree, sector):
    """The log of how much likelier a sector is in the leaf than among all, all equally likely."""
    known = [each for each in sector if each >= 0]
    often = [max(1, known.count(s)) for s in range(SECTORS)]
    rows = []
    for leaf in range(len(tree.leaf_start) - 1):
        members = tree.order[tree.leaf_start[leaf] : tree.leaf_start[leaf + 1]]
        counts = [0.0] * SECTORS
        for member in members:
            if sector[member] >= 0:
                counts[sector[member]] += 1
        even = [1 + counts[s] * np.mean(often) / often[s] for s in range(SECTORS)]
        logs = [math.log(each / sum(even) * SECTORS) for each in even]
        rows.append([max(-127, min(127, round(each / STEP))) for each in logs])
    return rows


NO_PRIOR = np.zeros(SECTORS)


@pytest.mark.parametrize('seed', range(4))
def test_what_leaves_know(seed):
    rng = np.random.default_rng(seed)
    sizes = [1, 50, 3, 200, 70]
    tree = leaf_tree(rng, sizes)
    # Some sectors are rare, one is never seen, and of some samples none is known.
    sector = rng.choice([-1, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6], sum(sizes))
    found = leaf_evidence(tree, sector, NO_PRIOR)
    assert found.dtype == np.int8
    assert found.tolist() == leaf_evidence_twin(tree, sector.tolist())


def test_a_leaf_that_knows_nobody_is_for_no_sector():
    tree = leaf_tree(np.random.default_rng(0), [6, 6])
    sector = np.full(12, -1)
    assert leaf_evidence(tree, sector, NO_PRIOR).tolist() == [[0] * SECTORS] * 2


def test_what_is_held_likelier_beforehand_is_likelier_in_every_leaf():
    tree = leaf_tree(np.random.default_rng(0), [6, 40])
    sector = np.random.default_rng(1).integers(0, SECTORS, 46)
    prior = STEP * np.arange(SECTORS)
    more = leaf_evidence(tree, sector, prior) - leaf_evidence(tree, sector, NO_PRIOR)
    np.testing.assert_array_equal(more, np.tile(np.arange(SECTORS), (2, 1)))


def test_what_most_people_do_is_no_evidence():
    """Nine in ten face the camera, in this leaf too: so it says nothing of who stands there."""
    sector = np.tile([3, 3, 3, 3, 3, 3, 3, 3, 3, 0], 200)
    tree = leaf_tree(np.random.default_rng(0), [1000, 1000])
    found = leaf_evidence(tree, sector, NO_PRIOR)
    assert np.abs(found[:, 3] - found[:, 0]).max() <= 4
    assert found[:, [3, 0]].min() > 10
    assert found[:, [1, 2, 4, 5, 6, 7]].max() < 0


POINTS = 30


def made_up(count, seed, unknown=0):
    """Return samples of people of whom two noisy levels reveal where they face, and that.

    The last two rows are free; of the last `unknown` people a hip is not labelled.
    """
    rng = np.random.default_rng(seed)
    facing = rng.uniform(-np.pi, np.pi, count)
    joints = np.stack([skeleton(each) for each in np.degrees(facing)])
    joints[count - unknown :, 2] = np.nan
    person = np.repeat(np.arange(count, dtype=np.int32), POINTS)
    levels = rng.integers(0, 256, (12, count * POINTS))
    levels[-2:] = 0
    told = np.stack([np.cos(facing), np.sin(facing)])[:, person]
    levels[4:6] = 127.5 + 80 * told + rng.normal(0, 15, told.shape)
    samples = Samples(
        levels.astype(np.uint8),
        rng.normal(0, 0.5, (count * POINTS, 3)).astype(np.float32),
        person,
        joints,
        np.ones(count, np.float32),
    )
    return samples, facing


SETTINGS = FacingSettings(
    growth=GrowthSettings(depth=8, leaf_samples=20, features=10), towards_camera=0.0
)


def test_made_up_people_are_found_within_a_sector():
    forest = teach_facing(made_up(300, 0)[0], NUMBERS, SETTINGS)
    assert len(forest.roots) == SETTINGS.trees
    assert set(np.unique(forest.feature[forest.feature >= 0])) >= {4, 5}
    assert forest.feature.max() < 10
    strangers, facing = made_up(80, 1)
    levels = strangers.levels[:-2].T.reshape(80, POINTS, 10)
    found = [find_facing(forest, np.ascontiguousarray(each)) for each in levels]
    assert apart(found, facing).max() < 2 * np.pi / SECTORS
    assert np.median(apart(found, facing)) < np.radians(15)


@pytest.mark.filterwarnings('error')
def test_the_free_rows_tell_where_people_face_a_little_off():
    samples, facing = made_up(400, 2, unknown=150)
    before = samples.levels.copy()
    teach_facing(samples, NUMBERS, SETTINGS)
    np.testing.assert_array_equal(samples.levels[:-2], before[:-2])
    rows = samples.levels[-2:].reshape(2, 400, POINTS)
    assert (rows == rows[..., :1]).all()  # all points of a person are told the same
    cosine, sine = rows[..., 0] - 127.5
    np.testing.assert_allclose(np.hypot(cosine, sine), 127, atol=1)
    off = np.angle(np.exp(1j * (np.arctan2(sine, cosine) - facing)))
    spread = np.degrees(off[:250].std())
    assert spread == pytest.approx(np.degrees(SETTINGS.uncertainty), rel=0.2)
    assert abs(off[:250].mean()) < np.radians(3)
    # Of whom it is not known, anything is told.
    assert np.bincount(sector_of(np.arctan2(sine, cosine)[250:]), minlength=SECTORS).min() > 5


def test_teaching_is_repeatable_and_the_seed_matters():
    results = []
    for seed in (0, 0, 1):
        samples, _ = made_up(60, 3, unknown=5)
        forest = teach_facing(samples, NUMBERS, SETTINGS._replace(seed=seed))
        results.append((*forest, samples.levels))
    first, again, other = results
    for one, two in zip(first, again, strict=True):
        np.testing.assert_array_equal(one, two)
    assert not np.array_equal(first[1], other[1])
    assert not np.array_equal(first[-1], other[-1])


def test_facings_of_nobody_cannot_be_learnt():
    samples, _ = made_up(5, 4, unknown=5)
    with pytest.raises(InputError, match=r'nobody is labelled with both .*--facing'):
        teach_facing(samples, NUMBERS, SETTINGS)


def test_people_who_all_face_the_same_way_are_found_to():
    samples, _ = made_up(40, 5)
    samples.joints[:] = skeleton(100)
    forest = teach_facing(samples, NUMBERS, SETTINGS)
    found = find_facing(forest, np.ascontiguousarray(samples.levels[:-2, :POINTS].T))
    sector = sector_of(np.array([np.radians(100)]))
    assert apart(found, sector_centres()[sector])[0] < np.radians(30)


def test_joined_trees_lead_to_their_own_leaves():
    """The second tree's nodes and leaves stand behind those of the first."""
    order = np.arange(4, dtype=np.int32)
    fork = Tree(
        np.array([5, -1, -1], np.int16),
        np.array([9, 0, 0], np.uint8),
        np.array([1, 0, 1], np.int32),
        order,
        np.array([0, 1, 4]),
    )
    stump = Tree(fork.feature[1:2], fork.threshold[1:2], fork.left[1:2], order, np.array([0, 4]))
    joined = join_trees([fork, stump, fork])
    assert joined.roots.tolist() == [0, 3, 4]
    assert joined.feature.tolist() == [5, -1, -1, -1, 5, -1, -1]
    assert joined.threshold.tolist() == [9, 0, 0, 0, 9, 0, 0]
    assert joined.left.tolist() == [1, 0, 1, 2, 5, 3, 4]
    assert [each.dtype for each in joined] == [np.int32, np.int16, np.uint8, np.int32]


@pytest.fixture(scope='module')
def strangers(all_round):
    """People from all sides whom the model has not seen."""
    return list(synthetic_frames(all_round._replace(frames=150, seed=77, clip_length=1)))


def test_a_model_finds_where_strangers_face(facing_model, strangers):
    seen = list(labelled_people(strangers, facing_model.joints, facing_model.settings))
    truth = people_facing(np.stack([person.joints for person in seen]), facing_model.joints)
    found = [find_facing(facing_model.facing, person.levels) for person in seen]
    off = np.degrees(apart(found, truth))
    assert (off < 90).mean() > 0.75
    assert (off < 45).mean() > 0.65


def test_who_is_told_where_people_face_tells_left_from_right(
    facing_model, all_round_people, training, strangers
):
    untold = train(all_round_people, training, {})
    hips, errors = [], []
    for model in (facing_model, untold):
        scores = summarise(evaluate(Estimator(model), strangers), 0.15)
        hips.append(np.mean([scores.joints[f'{side}_hip'].ap for side in 'lr']))
        errors.append(scores.mean_error_m)
    assert hips[0] > hips[1] + 0.03
    assert errors[0] < errors[1]


def test_of_two_sides_that_look_alike_the_one_is_taken_that_the_votes_agree_on(
    facing_model, all_round_people
):
    """Whichever side is asked for first, the answer is the same."""
    # Of a sector, that of who is seen from the other side.
    behind = [int(sector_of(math.pi - each)) for each in sector_centres()]
    turned = facing_model.facing._replace(evidence=facing_model.facing.evidence[:, behind].copy())
    other = Estimator(facing_model._replace(facing=turned))
    same = 0
    people = labelled_people(all_round_people[:20], facing_model.joints, facing_model.settings)
    for person in people:
        points = person.points * np.float32(person.scale)
        answers = [
            estimator.answer(points, person.levels, person.scale).joints
            for estimator in (Estimator(facing_model), other)
        ]
        same += bool(np.abs(answers[0] - answers[1]).max() < 1e-3)
    assert same >= 18
