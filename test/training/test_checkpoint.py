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

import errno
import itertools
import json
import os
import re
import shutil
import stat

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_check import MOST_TREES
from lsc_pose_ros.pose.forest.forest import LeafVotes
from lsc_pose_ros.training.checkpoint import FinishedTree, Limits
from lsc_pose_ros.training.checkpoint_file import CheckpointFile, checkpoint_path
from lsc_pose_ros.training.train import train

_VOTES = LeafVotes(
    np.array([0, 1], np.int32),
    np.zeros(1, np.uint8),
    np.zeros((1, 3), np.float32),
    np.ones(1, np.float32),
)
TREE = FinishedTree(
    np.array([-1], np.int16), np.zeros(1, np.uint8), np.zeros(1, np.int32), _VOTES, _VOTES
)
"""A tree of one leaf."""

LIMITS = Limits(features=10, joints=10, edges=10)


class InterruptedTrainingError(Exception):
    """Ends a training in the middle."""


def checkpoint_in(folder, *, resume=True, program='lsc_pose_ros 1', **told):
    return CheckpointFile(checkpoint_path(folder / 'me.npz'), program, resume=resume, **told)


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
    told = []
    checkpoint = checkpoint_in(interrupted, tell=told.append)
    model = train(few, training, {}, steps.append, checkpoint)
    (line,) = told
    assert re.fullmatch(r'1 of 2 trees are taken from .*me\.npz\.checkpoint', line)
    assert not any(step.startswith('growing tree 1') for step in steps)
    assert any(step.startswith('growing tree 2') for step in steps)
    assert_same_forest(model.forest, whole.forest)
    np.testing.assert_array_equal(model.calibration, whole.calibration)


def test_more_trees_can_be_asked_for(interrupted, few, training):
    longer = training._replace(trees=3)
    resumed = train(few, longer, {}, checkpoint=checkpoint_in(interrupted))
    assert_same_forest(resumed.forest, train(few, longer, {}).forest)


def test_trees_that_would_be_lost_are_told_of(interrupted):
    words = r'me\.npz\.checkpoint .* go on with --resume, or remove .*me\.npz\.checkpoint'
    before = checkpoint_path(interrupted / 'me.npz').read_bytes()
    with pytest.raises(InputError, match=words), checkpoint_in(interrupted, resume=False):
        raise AssertionError
    assert checkpoint_path(interrupted / 'me.npz').read_bytes() == before


def test_resume_without_a_checkpoint_warns(tmp_path):
    warnings = []
    with checkpoint_in(tmp_path, warn=warnings.append):
        pass
    (warning,) = warnings
    assert re.search(r'there is no checkpoint .*me\.npz\.checkpoint.* begins anew', warning)


def test_second_training_is_refused_while_the_first_runs(tmp_path):
    with checkpoint_in(tmp_path, resume=False) as checkpoint:
        checkpoint.store('key', [TREE])
        for resume in (False, True):
            with (
                pytest.raises(InputError, match='in use by another training'),
                checkpoint_in(tmp_path, resume=resume),
            ):
                raise AssertionError
        checkpoint.remove()
    assert list(tmp_path.iterdir()) == []


def test_trees_beyond_those_of_the_model_are_not_lost(tmp_path):
    told = []
    checkpoint = checkpoint_in(tmp_path, tell=told.append)
    checkpoint.store('key', [TREE] * 3)
    assert len(checkpoint.load('key', LIMITS, 2)) == 2
    checkpoint.remove()
    assert len(checkpoint.load('key', LIMITS, 5)) == 3
    assert [text.split(' from ')[0] for text in told[::2]] == [
        '2 of 2 trees are taken',
        '3 of 5 trees are taken',
    ]
    assert 'stays' in told[1]
    checkpoint.remove()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize('count', [1, 9, 10, MOST_TREES])
def test_as_many_trees_as_a_model_has_can_be_resumed(tmp_path, count):
    checkpoint_in(tmp_path).store('key', [TREE] * count)
    assert len(checkpoint_in(tmp_path).load('key', LIMITS, MOST_TREES)) == count


def test_archive_with_more_parts_is_refused(tmp_path):
    checkpoint_in(tmp_path).store('key', [TREE] * (MOST_TREES + 1))
    with pytest.raises(InputError, match='its parts are too many'):
        checkpoint_in(tmp_path).load('key', LIMITS, MOST_TREES)


def fill_disk(monkeypatch, full):
    """Let the writing of these trees, counted from 1, fail as on a full disk."""
    numbers = itertools.count(1)

    def save(stream, **arrays):
        if next(numbers) in full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        np.savez_compressed(stream, **arrays)

    monkeypatch.setattr(np, 'savez', save)


@pytest.mark.parametrize('full', [{1}, {2}, {1, 2}])
def test_full_disk_ends_no_training(tmp_path, few, training, whole, monkeypatch, full):
    fill_disk(monkeypatch, full)
    warnings = []
    with checkpoint_in(tmp_path, resume=False, warn=warnings.append) as checkpoint:
        model = train(few, training, {}, checkpoint=checkpoint)
        assert_same_forest(model.forest, whole.forest)
        (warning,) = warnings
        assert re.search('trees are not kept: .* No space left on device; .* goes on', warning)
        assert checkpoint_path(tmp_path / 'me.npz').exists() == (full != {1, 2})
        checkpoint.remove()
    assert list(tmp_path.iterdir()) == []


def test_folder_that_vanishes_ends_no_training(tmp_path):
    warnings = []
    folder = tmp_path / 'gone'
    folder.mkdir()
    with checkpoint_in(folder, resume=False, warn=warnings.append) as checkpoint:
        shutil.rmtree(folder)
        checkpoint.store('key', [TREE])
        folder.mkdir()
        checkpoint.store('key', [TREE] * 2)
    assert len(warnings) == 1
    assert len(checkpoint_in(folder).load('key', LIMITS, 2)) == 2


def test_link_is_followed_and_its_target_removed(tmp_path):
    (tmp_path / 'other').mkdir()
    link = checkpoint_path(tmp_path / 'me.npz')
    link.symlink_to(tmp_path / 'other' / 'trees')
    with checkpoint_in(tmp_path, resume=False) as checkpoint:
        checkpoint.store('key', [TREE])
        assert (tmp_path / 'other' / 'trees').is_file()
        checkpoint.remove()
    assert link.is_symlink()
    assert list((tmp_path / 'other').iterdir()) == []


def test_file_of_somebody_else_in_its_place_stays(tmp_path):
    warnings = []
    with checkpoint_in(tmp_path, resume=False, warn=warnings.append) as checkpoint:
        checkpoint.store('key', [TREE])
        path = checkpoint_path(tmp_path / 'me.npz')
        path.write_text('dear diary')
        checkpoint.remove()
    assert path.read_text() == 'dear diary'
    assert warnings == [f'{path} stays: it is no checkpoint']


def test_all_names_of_a_model_have_one_checkpoint(tmp_path):
    (tmp_path / 'other.npz').symlink_to(tmp_path / 'me.npz')
    assert checkpoint_path(tmp_path / 'other.npz') == checkpoint_path(tmp_path / 'me.npz')


def test_link_to_a_device_keeps_nothing(tmp_path):
    link = checkpoint_path(tmp_path / 'me.npz')
    link.symlink_to('/dev/null')
    warnings = []
    with checkpoint_in(tmp_path, resume=False, warn=warnings.append) as checkpoint:
        checkpoint.store('key', [TREE])
        assert checkpoint.load('key', LIMITS, 1) == []
        checkpoint.remove()
    assert warnings == []
    assert link.is_symlink()
    assert stat.S_ISCHR(link.stat().st_mode)


def test_joints_are_no_damage(interrupted, few, training):
    """Fewer joints make indices of the other training leave their limits."""
    fewer = training._replace(joints=training.joints[:2])
    with pytest.raises(
        InputError, match='belongs to a training with other recordings or settings'
    ):
        train(few, fewer, {}, checkpoint=checkpoint_in(interrupted))


@pytest.mark.parametrize('change', ['seed', 'people', 'depth', 'version'])
def test_checkpoint_of_another_training_is_refused(interrupted, few, training, change):
    if change == 'seed':
        training = training._replace(seed=1)
    if change == 'depth':
        training = training._replace(growth=training.growth._replace(depth=11))
    given = few[:-1] if change == 'people' else few
    program = 'lsc_pose_ros 2' if change == 'version' else 'lsc_pose_ros 1'
    with pytest.raises(
        InputError, match=r'me\.npz\.checkpoint belongs to .* remove it to begin anew'
    ):
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
    with pytest.raises(InputError, match=r'is not a usable checkpoint .* remove it to begin anew'):
        train(few, training, {}, checkpoint=checkpoint_in(interrupted))
