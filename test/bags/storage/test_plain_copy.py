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

"""The decompressed copy of a recording is whole up to a damage, or there is none."""

import resource
import tempfile

import pytest
import zstandard

from lsc_pose_ros.bags.storage.layout import Part, plain_copy
from lsc_pose_ros.errors import InputError


@pytest.fixture
def packed(labelled_recording, tmp_path):
    path = tmp_path / 'packed.mcap.zstd'
    path.write_bytes(zstandard.compress(labelled_recording.read_bytes()))
    return Part(path, 'mcap', compressed=True)


def test_copy_is_the_recording(packed, labelled_recording):
    with plain_copy(packed, 'copy') as copy:
        assert copy.read_bytes() == labelled_recording.read_bytes()
    assert not copy.exists()


def test_no_folder_for_temporary_files(packed, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path / 'gone'))
    with pytest.raises(InputError, match='TMPDIR'), plain_copy(packed, 'copy'):
        raise AssertionError


def test_full_disk_is_no_damage_of_the_recording(packed):
    """A copy that does not fit is not taken for a recording that is cut off."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with (
            pytest.raises(InputError, match='cannot be written: File too large'),
            plain_copy(packed, 'copy'),
        ):
            raise AssertionError
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
