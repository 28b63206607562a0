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

"""Telling where people face: from skeletons, in made-up samples, and what comes of it."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, summarise
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.training.body_yaw_labels import body_yaws_of_people, write_body_yaws
from lsc_pose_ros.training.samples import Samples
from lsc_pose_ros.training.train import train
from lsc_pose_ros.training.tree_growth import Tree, join_trees

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
    """Return the angles between directions, radians."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(one) - two))))


def test_body_yaw_of_skeletons():
    degrees = np.array([0, 30, 90, -90, 135, 179, 180, -179, -60])
    joints = np.stack([skeleton(each) for each in degrees])
    found = body_yaws_of_people(joints, NUMBERS)
    assert found.shape == degrees.shape
    assert apart(found, np.radians(degrees)).max() < 1e-5
    other_unit = body_yaws_of_people(joints / np.float32(0.7), NUMBERS)
    assert apart(found, other_unit).max() < 1e-5


@pytest.mark.parametrize('degrees', [0, 100, 170, -150])
def test_shoulders_and_hips_have_the_same_weight(degrees):
    found = body_yaws_of_people(skeleton(degrees, lean=40.0)[None], NUMBERS)
    assert apart(found, np.radians(degrees + 20.0))[0] < 0.01


@pytest.mark.parametrize('joint', range(len(NAMES)))
def test_body_yaw_is_unknown_without_a_shoulder_or_a_hip(joint):
    joints = np.stack([skeleton(0), skeleton(90)])
    joints[0, joint] = np.nan
    found = body_yaws_of_people(joints, NUMBERS)
    assert np.isnan(found[0]) == (NAMES[joint] != 'head')
    assert np.isfinite(found[1])


def test_missing_joints_are_named(people, training):
    few = numbers_of(['head', 'l_shoulder', 'l_hip', 'r_hip'])
    with pytest.raises(InputError, match=r'also learn r_shoulder, or leave out --body-yaw'):
        body_yaws_of_people(np.zeros((2, 4, 3), np.float32), few)
    none = numbers_of(['head', 'l_knee'])
    changed = training._replace(joints=none, settings=training.settings._replace(body_yaws=8))
    before = iter(people)
    with pytest.raises(InputError, match=r'learn l_shoulder, r_shoulder, l_hip, r_hip, or'):
        train(before, changed, {})
    assert next(before) is people[0]  # it fails before the frames are read


POINTS = 30


def made_up(count, seed, unknown=0):
    """Return samples of people with two features that depend on the body yaw, and the body yaws.

    The last two rows are spare; a hip of the last `unknown` people is not labelled.
    """
    rng = np.random.default_rng(seed)
    body_yaw = rng.uniform(-np.pi, np.pi, count)
    joints = np.stack([skeleton(each) for each in np.degrees(body_yaw)])
    joints[count - unknown :, 2] = np.nan
    person = np.repeat(np.arange(count, dtype=np.int32), POINTS)
    quantised = rng.integers(0, 256, (12, count * POINTS))
    quantised[-2:] = 0
    features = np.stack([np.cos(body_yaw), np.sin(body_yaw)])[:, person]
    quantised[4:6] = 127.5 + 80 * features + rng.normal(0, 15, features.shape)
    samples = Samples(
        quantised.astype(np.uint8),
        rng.normal(0, 0.5, (count * POINTS, 3)).astype(np.float32),
        person,
        joints,
        np.ones(count, np.float32),
    )
    return samples, body_yaw


@pytest.mark.filterwarnings('error')
def test_spare_rows_are_noisy_body_yaws():
    samples, body_yaw = made_up(400, 2, unknown=150)
    before = samples.quantised.copy()
    write_body_yaws(samples, NUMBERS, 0)
    np.testing.assert_array_equal(samples.quantised[:-2], before[:-2])
    rows = samples.quantised[-2:].reshape(2, 400, POINTS)
    assert (rows == rows[..., :1]).all()  # all points of a person have the same yaw
    cosine, sine = rows[..., 0] - 127.5
    np.testing.assert_allclose(np.hypot(cosine, sine), 127, atol=1)
    written = np.arctan2(sine, cosine)
    off = np.angle(np.exp(1j * (written - body_yaw)))[:250]
    # The estimator tries yaws that are 45 degrees apart.
    assert np.degrees(off.std()) == pytest.approx(12, rel=0.2)
    assert abs(off.mean()) < np.radians(3)
    # An unknown yaw is random.
    eighths = ((written[250:] + np.pi) * 4 / np.pi).astype(int) % 8
    assert np.bincount(eighths, minlength=8).min() > 5


def test_body_yaws_are_repeatable_and_depend_on_the_seed():
    first, again, other = (made_up(60, 3, unknown=5)[0] for _ in range(3))
    write_body_yaws(first, NUMBERS, 0)
    write_body_yaws(again, NUMBERS, 0)
    write_body_yaws(other, NUMBERS, 1)
    np.testing.assert_array_equal(first.quantised, again.quantised)
    known, unknown = first.person < 55, first.person >= 55
    for some in (known, unknown):
        assert not np.array_equal(first.quantised[-2:, some], other.quantised[-2:, some])


def test_at_least_one_body_yaw_must_be_known():
    samples, _ = made_up(5, 4, unknown=5)
    with pytest.raises(InputError, match=r'nobody is labelled with both .*--body-yaw'):
        write_body_yaws(samples, NUMBERS, 0)


def test_joined_trees_lead_to_their_own_leaves():
    """Nodes and leaves of a tree follow those of the tree before."""
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
    """People from all sides that are not in the training."""
    return list(synthetic_frames(all_round._replace(frames=150, seed=77, clip_length=1)))


def test_body_yaw_improves_hips_of_people_from_all_sides(
    body_yaw_model, all_round_people, training, strangers
):
    without = train(all_round_people, training._replace(trees=3), {})
    hips, errors = [], []
    for model in (body_yaw_model, without):
        scores = summarise(evaluate(Estimator(model), strangers), 0.15)
        hips.append(np.mean([scores.joints[f'{side}_hip'].ap for side in 'lr']))
        errors.append(scores.mean_error_m)
    assert hips[0] > hips[1] + 0.06
    assert errors[0] < errors[1] - 0.005


def test_forest_splits_by_the_body_yaw(body_yaw_model, small_model):
    splits = np.bincount(body_yaw_model.forest.feature[body_yaw_model.forest.feature >= 0])
    assert len(splits) == body_yaw_model.feature_size == 362
    assert splits[-2:].min() > 3 * splits[:-2].mean()  # they are tried at every node
    assert small_model.forest.feature.max() < small_model.feature_size == 360
