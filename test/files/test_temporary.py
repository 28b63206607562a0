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

"""Without a folder for temporary files, commands say so."""

import tempfile

import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.temporary import temporary_file, temporary_folder


@pytest.fixture
def nowhere(tmp_path, monkeypatch):
    """No folder that Python tries can be written."""
    monkeypatch.setattr(tempfile, '_candidate_tempdir_list', lambda: [str(tmp_path / 'missing')])
    monkeypatch.setattr(tempfile, 'tempdir', None)


def test_files_and_folders_are_gone_at_the_end():
    with temporary_folder() as folder:
        (folder / 'a').write_bytes(b'x')
    assert not folder.exists()
    with temporary_file() as stream:
        stream.write(b'x')
        assert stream.seek(0) == 0
        assert stream.read() == b'x'


@pytest.mark.usefixtures('nowhere')
def test_no_folder_for_temporary_files():
    words = 'no temporary file can be written .*; name a folder .* TMPDIR'
    with pytest.raises(InputError, match=words), temporary_folder():
        raise AssertionError
    with pytest.raises(InputError, match=words):
        temporary_file()


def test_folder_that_vanishes(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path / 'gone'))
    with pytest.raises(InputError, match=r'No such file or directory.*TMPDIR'), temporary_folder():
        raise AssertionError
