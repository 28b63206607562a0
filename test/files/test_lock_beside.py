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

"""One program at a time has the lock of a file, and a killed one has none."""

import os
import signal
import subprocess
import sys

import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.lock_beside import locked


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_second_is_refused_until_the_first_ends(tmp_path):
    path = tmp_path / 'me'
    with locked(path, 'busy'):
        for _ in range(2):
            with pytest.raises(InputError, match='busy'), locked(path, 'busy'):
                raise AssertionError
        with locked(tmp_path / 'other', 'busy'):
            pass
    assert names(tmp_path) == []
    with locked(path, 'busy'):
        pass
    assert names(tmp_path) == []


def test_error_releases_the_lock(tmp_path):
    with pytest.raises(ZeroDivisionError), locked(tmp_path / 'me', 'busy'):
        raise ZeroDivisionError
    with locked(tmp_path / 'me', 'busy'):
        pass
    assert names(tmp_path) == []


def test_link_has_the_lock_of_its_target(tmp_path):
    (tmp_path / 'link').symlink_to('me')
    with (
        locked(tmp_path / 'me', 'busy'),
        pytest.raises(InputError, match='busy'),
        locked(tmp_path / 'link', 'busy'),
    ):
        raise AssertionError


_HOLDER = """
import signal, sys
from pathlib import Path
from lsc_pose_ros.files.lock_beside import locked
with locked(Path(sys.argv[1]), 'busy'):
    print('locked', flush=True)
    signal.pause()
"""


@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGTERM])
def test_killed_process_has_no_lock(tmp_path, number):
    path = tmp_path / 'me'
    with subprocess.Popen(
        [sys.executable, '-c', _HOLDER, str(path)], stdout=subprocess.PIPE, text=True
    ) as holder:
        assert holder.stdout.readline() == 'locked\n'
        with pytest.raises(InputError, match='busy'), locked(path, 'busy'):
            raise AssertionError
        holder.send_signal(number)
        holder.wait()
        with locked(path, 'busy'):
            pass
    assert names(tmp_path) == []


def test_file_that_the_holder_removes_is_no_lock(tmp_path, monkeypatch):
    """The first ends while the second opens the file: then a third has no lock beside it."""
    path = tmp_path / 'me'
    opened = os.open

    def open_after_the_end(file, *arguments):
        descriptor = opened(file, *arguments)
        monkeypatch.setattr(os, 'open', opened)
        first.__exit__(None, None, None)
        return descriptor

    first = locked(path, 'busy')
    first.__enter__()
    monkeypatch.setattr(os, 'open', open_after_the_end)
    with locked(path, 'busy'):
        assert names(tmp_path) == ['.me.lock']
        with pytest.raises(InputError, match='busy'), locked(path, 'busy'):
            raise AssertionError
    assert names(tmp_path) == []


def test_file_system_without_locks(tmp_path, monkeypatch):
    def no_locks(*_):
        raise OSError(95, 'Operation not supported')

    monkeypatch.setattr('lsc_pose_ros.files.file_lock.fcntl.flock', no_locks)
    with locked(tmp_path / 'me', 'busy'), locked(tmp_path / 'me', 'busy'):
        pass


def test_folder_that_does_not_exist(tmp_path):
    with (
        pytest.raises(InputError, match=r'\.me\.lock: cannot be written: No such file'),
        locked(tmp_path / 'missing' / 'me', 'busy'),
    ):
        raise AssertionError
