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

"""Division of recordings into training and test frames."""

import pytest
from lsc_pose_experiments.protocol import DataSelection, FrameSampler, fold_key, folds_of

from lsc_pose_ros.errors import InputError


@pytest.fixture
def paths(tmp_path):
    """Three placeholder files of recordings."""
    found = [tmp_path / f'{name}.mcap' for name in 'abc']
    for path in found:
        path.write_bytes(b'recording')
    return tuple(found)


@pytest.fixture
def read(paths, people):
    """40 frames of each recording."""
    frames = {path: people[40 * n : 40 * n + 40] for n, path in enumerate(paths)}
    return frames.__getitem__


def poses(drawn):
    return {each.ground_truth.positions.tobytes() for each in drawn}


def poses_of(frames):
    return {frame.ground_truth.positions.tobytes() for frame in frames}


def test_random_divides_the_frames_of_all(paths, read):
    selection = DataSelection(paths, test_frames=15)
    (fold,) = folds_of(selection)
    frames = FrameSampler(selection, 1000, read).frames(fold)
    assert (len(frames.train), len(frames.test)) == (105, 15)
    assert not poses(frames.train) & poses(frames.test)
    # Test frames and the first training frames do not depend on the number of frames.
    fewer = FrameSampler(selection, 10, read).frames(fold)
    assert poses(fewer.test) == poses(frames.test)
    assert poses(fewer.train[:10]) == poses(frames.train[:10])
    other = FrameSampler(selection._replace(seed=1), 10, read).frames(fold)
    assert poses(other.test) != poses(frames.test)


def test_fifth_of_few_frames_is_tested(paths, read):
    selection = DataSelection(paths, test_frames=900)
    frames = FrameSampler(selection, 3600, read).frames(folds_of(selection)[0])
    assert (len(frames.train), len(frames.test)) == (96, 24)


def test_other_recordings_are_tested(paths, read):
    selection = DataSelection(paths[:1], paths[1:], 'recordings', test_frames=50)
    (fold,) = folds_of(selection)
    frames = FrameSampler(selection, 30, read).frames(fold)
    assert len(frames.test) == 50
    assert poses(frames.train) <= poses_of(read(paths[0]))
    assert poses(frames.test) <= poses_of(read(paths[1]) + read(paths[2]))


def test_each_recording_is_tested_once(paths, read):
    selection = DataSelection(paths, protocol='leave-one-out', test_frames=100)
    folds = folds_of(selection)
    draws = FrameSampler(selection, 100, read)
    for fold, path in zip(folds, paths, strict=True):
        frames = draws.frames(fold)
        assert poses(frames.test) == poses_of(read(path))
        assert len(frames.train) == 80
        assert not poses(frames.train) & poses(frames.test)


def test_recording_is_read_once(paths, read):
    asked = []

    def count(path):
        asked.append(path)
        return read(path)

    selection = DataSelection(paths, protocol='leave-one-out', test_frames=5)
    draws = FrameSampler(selection, 5, count)
    for fold in folds_of(selection):
        draws.frames(fold)
    assert sorted(asked) == sorted(paths)


def test_key_changes_with_everything_that_determines_the_frames(paths):
    selection = DataSelection(paths, protocol='leave-one-out')
    first, second, _ = folds_of(selection)
    keys = [
        fold_key(selection, first),
        fold_key(selection, second),
        fold_key(selection._replace(seed=1), first),
        fold_key(selection._replace(test_frames=10), first),
        fold_key(selection._replace(topics=('/other',)), first),
        fold_key(selection._replace(protocol='random'), first),
    ]
    paths[0].write_bytes(b'another recording')
    keys.append(fold_key(selection, first))
    assert all(keys.count(key) == 1 for key in keys)


@pytest.mark.parametrize(
    ('protocol', 'recordings', 'tests', 'words'),
    [
        ('recordings', 1, 0, 'needs --test'),
        ('random', 1, 1, 'takes no --test'),
        ('leave-one-out', 1, 0, 'needs two --recordings or more'),
    ],
)
def test_recordings_must_fit_the_protocol(protocol, recordings, tests, words, paths):
    with pytest.raises(InputError, match=words):
        folds_of(DataSelection(paths[:recordings], paths[recordings:][:tests], protocol))


def test_too_few_frames(paths, people):
    selection = DataSelection(paths[:1])
    with pytest.raises(InputError, match=r'a\.mcap: too few labelled frames'):
        FrameSampler(selection, 10, lambda _path: people[:3]).frames(folds_of(selection)[0])
