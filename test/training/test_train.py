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

import tracemalloc

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, joint_errors, summarise
from lsc_pose_ros.model_io.model_check import MOST_SPLITS, MOST_TREES, MOST_VOTES
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.training.criterion import offset_moments
from lsc_pose_ros.training.leaves import LeafSettings
from lsc_pose_ros.training.samples import (
    LabelledPerson,
    gather_samples,
    labelled_people,
    labelled_people_in,
    sample_limit,
    select_joints,
)
from lsc_pose_ros.training.train import GIBIBYTE, TrainingSettings, limb_lengths, train
from lsc_pose_ros.training.tree_growth import GrowthSettings


@pytest.fixture(scope='module')
def strangers(easy):
    """People that are not in the training."""
    return list(synthetic_frames(easy._replace(frames=40, seed=77, clip_length=8)))


@pytest.mark.parametrize('graph', [True, False])
def test_small_model_finds_strangers(small_model, strangers, graph):
    evaluation = evaluate(Estimator(small_model, graph=graph), strangers)
    summary = summarise(evaluation, 0.1)
    assert len(evaluation.seconds) == 40
    assert summary.map > 0.7
    assert summary.mean_error_m < 0.12


def test_training_is_repeatable(people, training):
    first, again = (train(people[:60], training, {}) for _ in range(2))
    for one, two in zip(first.forest[:4], again.forest[:4], strict=True):
        np.testing.assert_array_equal(one, two)
    np.testing.assert_array_equal(first.forest.joint_votes.offset, again.forest.joint_votes.offset)


def samples_of(frames, training):
    return gather_samples(
        person
        for frame in frames
        for person in labelled_people_in(frame, training.joints, training.settings)
    )


def test_samples_are_in_units_of_rho_bar(people, training):
    samples = samples_of(people[:5], training)
    assert samples.quantised.shape == (360, len(samples.points))
    assert len(samples.scale) == 5
    ground_truth = people[3].ground_truth
    wanted = select_joints(ground_truth, training.joints)[0]
    np.testing.assert_allclose(samples.joints[3] * samples.scale[3], wanted, rtol=1e-5)
    depths = (samples.points * samples.scale[samples.person][:, None])[samples.person == 3, 2]
    body = people[3].depth[(people[3].labels >= 0) & (people[3].depth > 0)]
    assert body.min() - 0.05 < depths.min() <= depths.max() < body.max() + 0.05


def test_limb_lengths_are_means_over_the_people(people, training):
    samples = samples_of(people[:9], training)
    places = np.stack([select_joints(f.ground_truth, training.joints)[0] for f in people[:9]])
    edges = np.array([[1, 0], [2, 3]], np.int32)
    expected = [np.linalg.norm(places[:, a] - places[:, b], axis=-1).mean() for a, b in edges]
    np.testing.assert_allclose(limb_lengths(samples, edges), expected, rtol=1e-4)


@pytest.mark.parametrize(
    ('change', 'reason'),
    [
        ({'trees': MOST_TREES + 1}, 'it has 101 trees; the limit is 100'),
        ({'growth': GrowthSettings(depth=MOST_SPLITS + 1)}, '129 splits above a leaf'),
        ({'leaves': LeafSettings(clusters=MOST_VOTES // 8 + 1)}, 'votes in a leaf'),
        ({'settings': Settings(points=1001)}, 'its setting points is 1001'),
        ({'settings': Settings(joint_bandwidth=0.0)}, 'bandwidths are not positive'),
    ],
)
def test_model_that_no_file_can_hold_is_refused_before_the_frames_are_read(
    training, change, reason
):
    def frames():
        raise AssertionError
        yield

    with pytest.raises(InputError, match=f'no file can hold a model.*{reason}'):
        train(frames(), training._replace(**change), {})


def test_joint_that_nobody_labels_is_named(people, training):
    frames = [
        frame._replace(
            ground_truth=frame.ground_truth._replace(
                joints=frame.ground_truth.joints[:4],
                positions=frame.ground_truth.positions[:, :4],
                confidence=frame.ground_truth.confidence[:, :4],
            )
        )
        for frame in people[:3]
    ]
    with pytest.raises(InputError, match=r'no frame labels l_shoulder, .*--joints'):
        train(frames, training, {})


@pytest.mark.parametrize('change', ['no truth', 'another number', 'empty mask', 'no frames'])
def test_nobody_to_learn_from_is_an_input_error(people, training, change):
    frame = people[0]
    frames = {
        'no truth': [frame._replace(ground_truth=None)],
        'another number': [frame._replace(labels=np.where(frame.labels >= 0, 9, NO_BODY))],
        'empty mask': [frame._replace(labels=np.full_like(frame.labels, NO_BODY))],
        'no frames': [],
    }[change]
    with pytest.raises(InputError, match='no labelled person'):
        train(frames, training, {})


def test_unlabelled_joints_do_not_hurt(people, training):
    """An elbow of every third person is not labelled; it is learnt from the others."""
    elbow = 5
    frames = []
    for number, frame in enumerate(people[:60]):
        positions = frame.ground_truth.positions.copy()
        positions[:, elbow] = np.nan if number % 3 == 0 else positions[:, elbow]
        frames.append(
            frame._replace(ground_truth=frame.ground_truth._replace(positions=positions))
        )
    model = train(frames, training, {})
    assert np.isfinite(model.forest.joint_votes.offset).all()
    assert np.isfinite(model.limb_lengths).all()
    column = list(training.joints).index(elbow)
    assert (model.forest.joint_votes.target == column).any()


def skeletons(bodies, joints, positions):
    positions = np.array(positions, np.float32)
    return Skeletons(
        np.array(bodies, np.uint16),
        np.array(joints, np.uint16),
        positions,
        np.ones(positions.shape[:2], np.float32),
    )


def test_errors_are_matched_by_body_and_joint_number():
    ground_truth = skeletons(
        [3, 5, 8], [0, 4], [[[0, 0, 2], [1, 0, 2]], [[9, 9, 9], [np.nan] * 3], [[0] * 3] * 2]
    )
    found = skeletons(
        [5, 3], [4, 0, 1], [[[0] * 3, [9, 9, 9.5], [0] * 3], [[1, 0.3, 2], [np.nan] * 3, [0] * 3]]
    )
    errors = joint_errors(found, ground_truth)
    np.testing.assert_allclose(
        errors, [[0.3, np.inf, np.nan], [np.nan, 0.5, np.nan], [np.inf, np.inf, np.nan]], rtol=1e-6
    )


def test_what_is_missing_is_missed_and_what_is_unlabelled_does_not_count(small_model, strangers):
    evaluation = evaluate(Estimator(small_model), strangers[:1])._replace(
        joints=numbers_of(['head', 'neck', 'torso']),
        errors=np.array([[0.05, np.inf, np.nan], [0.2, 0.1, np.nan]], np.float32),
    )
    summary = summarise(evaluation, 0.1)
    assert list(summary.joints) == ['head', 'neck']
    assert summary.joints['head'] == pytest.approx((0.125, 0.5, 2))
    assert summary.joints['neck'] == pytest.approx((0.1, 0.5, 2))
    assert summary.map == pytest.approx(0.5)
    assert summary.mean_error_m == pytest.approx(0.1125)


def test_frames_without_labels_cannot_be_evaluated(small_model, strangers):
    with pytest.raises(InputError, match='no frame has a labelled person'):
        evaluate(
            Estimator(small_model), [frame._replace(ground_truth=None) for frame in strangers[:2]]
        )


def crowd(count, points=64):
    """Yield people whose points and descriptors identify them."""
    for number in range(count):
        yield LabelledPerson(
            np.full((points, 360), number % 256, np.uint8),
            np.arange(3.0 * points, dtype=np.float32).reshape(points, 3),
            np.full((2, 3), number, np.float32),
            1.0,
        )


def test_too_many_samples_leave_fewer_points_of_everybody():
    samples = gather_samples(crowd(50), 50 * 64 // 3)
    assert len(samples.scale) == 50
    assert np.bincount(samples.person).tolist() == [16] * 50
    np.testing.assert_array_equal(samples.quantised[0], samples.person)
    np.testing.assert_array_equal(samples.joints[:, 0, 0], np.arange(50))
    np.testing.assert_array_equal(samples.points[:16, 0], 3 * 4 * np.arange(16))


def test_at_least_a_point_of_everybody_is_kept():
    assert np.bincount(gather_samples(crowd(9), 1).person).tolist() == [1] * 9


def test_memory_does_not_grow_with_the_recording():
    peaks = []
    for count in (400, 1600):
        tracemalloc.start()
        samples = gather_samples(crowd(count), 10_000)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert 5_000 <= len(samples.points) <= 10_000
    # 10,000 descriptors are 3.6 MB; in full, 1,600 people would be 37 MB.
    assert max(peaks) < 12e6
    assert peaks[1] < 1.3 * peaks[0]


def bytes_per_sample(joints):
    """The memory that `sample_limit` reserves for one more sample."""
    most, less = (sample_limit(memory, joints, 360) for memory in (2e12, 1e12))
    return 1e12 / (most - less)


def test_memory_is_reserved_for_the_offsets_to_the_joints_in_reach(people):
    """A joint in reach takes 17 bytes, twice while a node is split: its number and four floats."""
    training = TrainingSettings(numbers_of(DEFAULT_JOINTS))
    found = gather_samples(labelled_people(people[::6], training.joints, training.settings))
    moments = offset_moments(found.points, found.person, found.joints, training.criterion_reach)
    per_sample = (moments.joint.nbytes + moments.value.nbytes) / len(found.points)
    needed_per_joint = 2 * per_sample / len(training.joints)
    reserved_per_joint = (bytes_per_sample(220) - bytes_per_sample(20)) / 200
    assert needed_per_joint <= reserved_per_joint <= 2 * needed_per_joint


def test_more_memory_holds_more_samples():
    assert sample_limit(8 * GIBIBYTE, 17, 360) > 20_000 * 400
    assert sample_limit(GIBIBYTE, 17, 360) < 1_000_000
    assert sample_limit(0, 17, 360) == 1


def test_millimetres_are_refused(people, training):
    frames = [each._replace(depth=(each.depth * 1000).astype(np.uint16)) for each in people[:2]]
    with pytest.raises(InputError, match='metres_from_millimetres'):
        train(frames, training, {})
