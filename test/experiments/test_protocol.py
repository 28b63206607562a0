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

"""Which frames are learnt from, and which tested."""

import pytest
from lsc_pose_experiments.protocol import Draws, Study, fold_key, folds_of

from lsc_pose_ros.errors import InputError


@pytest.fixture
def paths(tmp_path):
    """Three files that stand for recordings."""
    found = [tmp_path / f'{name}.mcap' for name in 'abc']
    for path in found:
        path.write_bytes(b'recording')
    return tuple(found)


@pytest.fixture
def read(paths, people):
    """The frames of each: 40 of its own."""
    frames = {path: people[40 * n : 40 * n + 40] for n, path in enumerate(paths)}
    return frames.__getitem__


def poses(drawn):
    return {each.ground_truth.positions.tobytes() for each in drawn}


def poses_of(frames):
    return {frame.ground_truth.positions.tobytes() for frame in frames}


def test_random_divides_the_frames_of_all(paths, read):
    study = Study(paths, test_frames=15)
    (fold,) = folds_of(study)
    frames = Draws(study, 1000, read).frames(fold)
    assert (len(frames.train), len(frames.test)) == (105, 15)
    assert not poses(frames.train) & poses(frames.test)
    # However many are wanted, the same are tested, and the same learnt from first.
    fewer = Draws(study, 10, read).frames(fold)
    assert poses(fewer.test) == poses(frames.test)
    assert poses(fewer.train[:10]) == poses(frames.train[:10])
    other = Draws(study._replace(seed=1), 10, read).frames(fold)
    assert poses(other.test) != poses(frames.test)


def test_of_few_frames_a_fifth_is_tested(paths, read):
    study = Study(paths, test_frames=900)
    frames = Draws(study, 3600, read).frames(folds_of(study)[0])
    assert (len(frames.train), len(frames.test)) == (96, 24)


def test_other_recordings_are_tested(paths, read):
    study = Study(paths[:1], paths[1:], 'recordings', test_frames=50)
    (fold,) = folds_of(study)
    frames = Draws(study, 30, read).frames(fold)
    assert len(frames.test) == 50
    assert poses(frames.train) <= poses_of(read(paths[0]))
    assert poses(frames.test) <= poses_of(read(paths[1]) + read(paths[2]))


def test_each_recording_is_tested_once(paths, read):
    study = Study(paths, protocol='leave-one-out', test_frames=100)
    folds = folds_of(study)
    draws = Draws(study, 100, read)
    for fold, path in zip(folds, paths, strict=True):
        frames = draws.frames(fold)
        assert poses(frames.test) == poses_of(read(path))
        assert len(frames.train) == 80
        assert not poses(frames.train) & poses(frames.test)


def test_a_recording_is_read_once(paths, read):
    asked = []

    def count(path):
        asked.append(path)
        return read(path)

    study = Study(paths, protocol='leave-one-out', test_frames=5)
    draws = Draws(study, 5, count)
    for fold in folds_of(study):
        draws.frames(fold)
    assert sorted(asked) == sorted(paths)


def test_a_key_changes_with_all_that_decides_the_frames(paths):
    study = Study(paths, protocol='leave-one-out')
    first, second, _ = folds_of(study)
    keys = [
        fold_key(study, first),
        fold_key(study, second),
        fold_key(study._replace(seed=1), first),
        fold_key(study._replace(test_frames=10), first),
        fold_key(study._replace(topics=('/other',)), first),
        fold_key(study._replace(protocol='random'), first),
    ]
    paths[0].write_bytes(b'another recording')
    keys.append(fold_key(study, first))
    assert all(keys.count(key) == 1 for key in keys)


@pytest.mark.parametrize(
    ('protocol', 'recordings', 'tests', 'words'),
    [
        ('recordings', 1, 0, 'needs --test'),
        ('random', 1, 1, 'takes no --test'),
        ('leave-one-out', 1, 0, 'needs two --recordings or more'),
    ],
)
def test_protocols_that_cannot_be(protocol, recordings, tests, words, paths):
    with pytest.raises(InputError, match=words):
        folds_of(Study(paths[:recordings], paths[recordings:][:tests], protocol))


def test_too_few_frames(paths, people):
    study = Study(paths[:1])
    with pytest.raises(InputError, match=r'a\.mcap: too few labelled frames'):
        Draws(study, 10, lambda _path: people[:3]).frames(folds_of(study)[0])
