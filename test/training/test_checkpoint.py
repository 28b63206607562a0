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

import json
import shutil

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.training.checkpoint_file import CheckpointFile, checkpoint_path
from lsc_pose_ros.training.train import train


class InterruptedTrainingError(Exception):
    """Ends a training in the middle."""


def checkpoint_in(folder, *, resume=True, program='lsc_pose_ros 1'):
    return CheckpointFile(checkpoint_path(folder / 'me.npz'), program, resume=resume)


def interrupt_at(step):
    def progress(text):
        if text.startswith(step):
            raise InterruptedTrainingError

    return progress


@pytest.fixture(scope='module')
def few(people):
    """Enough people for a forest."""
    return people[:60]


@pytest.fixture(scope='module')
def whole(few, training):
    """The model of a training that nothing interrupts."""
    return train(few, training, {})


@pytest.fixture(scope='module')
def kept(few, training, tmp_path_factory):
    """A checkpoint with the first tree of two."""
    folder = tmp_path_factory.mktemp('kept')
    with pytest.raises(InterruptedTrainingError):
        train(few, training, {}, interrupt_at('growing tree 2'), checkpoint_in(folder))
    return checkpoint_path(folder / 'me.npz')


@pytest.fixture
def interrupted(kept, tmp_path):
    """A folder of its own with the checkpoint."""
    shutil.copy(kept, tmp_path)
    return tmp_path


def assert_same_forest(one, other):
    arrays = [*one[:4], *one.joint_votes, *one.pair_votes]
    others = [*other[:4], *other.joint_votes, *other.pair_votes]
    for array, same in zip(arrays, others, strict=True):
        assert array.dtype == same.dtype
        np.testing.assert_array_equal(array, same)


def test_resumed_training_has_the_same_forest(interrupted, few, training, whole):
    steps = []
    model = train(few, training, {}, steps.append, checkpoint_in(interrupted))
    assert not any(step.startswith('growing tree 1') for step in steps)
    assert any(step.startswith('growing tree 2') for step in steps)
    assert_same_forest(model.forest, whole.forest)
    np.testing.assert_array_equal(model.calibration, whole.calibration)


def test_more_trees_can_be_asked_for(interrupted, few, training):
    longer = training._replace(trees=3)
    resumed = train(few, longer, {}, checkpoint=checkpoint_in(interrupted))
    assert_same_forest(resumed.forest, train(few, longer, {}).forest)


def test_without_resume_the_training_begins_anew(interrupted, few, training, whole):
    steps = []
    model = train(few, training, {}, steps.append, checkpoint_in(interrupted, resume=False))
    assert any(step.startswith('growing tree 1') for step in steps)
    assert_same_forest(model.forest, whole.forest)


@pytest.mark.parametrize('change', ['seed', 'people', 'depth', 'version'])
def test_checkpoint_of_another_training_is_refused(interrupted, few, training, change):
    if change == 'seed':
        training = training._replace(seed=1)
    if change == 'depth':
        training = training._replace(growth=training.growth._replace(depth=11))
    given = few[:-1] if change == 'people' else few
    program = 'lsc_pose_ros 2' if change == 'version' else 'lsc_pose_ros 1'
    with pytest.raises(InputError, match=r'me\.npz\.checkpoint belongs to .* without --resume'):
        train(given, training, {}, checkpoint=checkpoint_in(interrupted, program=program))


def parts_of(path):
    with np.load(path) as stored:
        return {name: stored[name] for name in stored}


@pytest.mark.parametrize(
    ('name', 'value'),
    [
        ('0_left', -1), ('0_left', 1 << 30), ('0_feature', 32767),
        ('0_joint_votes_target', 200), ('0_pair_votes_target', 200), ('0_joint_votes_start', -5),
        ('0_joint_votes_offset', np.nan), ('0_pair_votes_weight', -1.0),
    ],
)  # fmt: skip
def test_index_that_leads_outside_is_refused(interrupted, few, training, name, value):
    path = checkpoint_path(interrupted / 'me.npz')
    parts = parts_of(path)
    parts[name].flat[0] = value
    with path.open('wb') as stream:
        np.savez(stream, **parts)
    with pytest.raises(InputError, match=r'me\.npz\.checkpoint is not a usable checkpoint'):
        train(few, training, {}, checkpoint=checkpoint_in(interrupted))


@pytest.mark.parametrize(
    ('field', 'value'), [('trees', 10**9), ('trees', 'x'), ('version', 99), ('format', 'x')]
)
def test_header_of_another_kind_is_refused(interrupted, few, training, field, value):
    path = checkpoint_path(interrupted / 'me.npz')
    parts = parts_of(path)
    header = json.loads(parts['header'].tobytes()) | {field: value}
    parts['header'] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    with path.open('wb') as stream:
        np.savez(stream, **parts)
    with pytest.raises(InputError, match='is not a usable checkpoint'):
        train(few, training, {}, checkpoint=checkpoint_in(interrupted))


def test_damaged_checkpoint_is_refused(interrupted, few, training):
    path = checkpoint_path(interrupted / 'me.npz')
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(InputError, match=r'is not a usable checkpoint .* train without --resume'):
        train(few, training, {}, checkpoint=checkpoint_in(interrupted))
