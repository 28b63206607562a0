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
"""What the journal of an annotation survives, and which files it leaves alone."""

import errno
import fcntl
import json
import os
import resource
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.annotation.frame_labels import FrameLabels, from_json
from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal, RecordingIdentity
from lsc_pose_ros.annotation.journal_file import JournalFile
from lsc_pose_ros.annotation.refusals import Reason, RefusedError
from lsc_pose_ros.errors import InputError

STAMPS = [10, 20, 30]
BAG = RecordingIdentity('bag.mcap', 'aa', STAMPS)


def labels(number: int) -> FrameLabels:
    head = {'position': [0.1, 0.2, 2.0], 'hidden': False}
    return from_json([{'number': number, 'joints': {'head': head}}])


def opened(path: Path, recording: RecordingIdentity = BAG) -> 'closing[Journal]':
    """Return the journal in a file, which is closed at the end."""
    file = JournalFile(path)
    try:
        return closing(Journal(file, recording))
    except InputError:
        file.close()
        raise


def fill(path: Path) -> bytes:
    """Write a journal of three changes, and return its content."""
    with opened(path) as journal:
        for number, stamp in enumerate(STAMPS):
            journal.keep(stamp, labels(number + 1), done=True)
    return path.read_bytes()


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_the_journal_survives_a_cut_at_any_byte(tmp_path) -> None:
    path = tmp_path / 'journal'
    content = fill(path)
    ends = [at for at, byte in enumerate(content) if byte == ord('\n')]
    for length in range(len(content) + 1):
        path.write_bytes(content[:length])
        with opened(path) as journal:
            # A change is there if all but its line end is.
            whole = sum(length >= end for end in ends[1:])
            assert list(journal.frames) == STAMPS[:whole]
            is_clean = length in {0, len(content), *ends, *(end + 1 for end in ends)}
            assert len(journal.warnings) == (0 if is_clean or length < ends[0] else 1)
            journal.keep(30, labels(7), done=False)
        with opened(path) as again:
            assert list(again.frames) == [*STAMPS[: min(whole, 2)], 30]
            assert list(again.frames[30][0]) == [7]
            assert not again.warnings
    assert names_in(tmp_path) == ['journal']


DAMAGES = [
    b'',
    b'\0' * 40,
    b'{"stamp": 20',
    b'[' * 100_000,
    b'{"stamp": 21, "bodies": [], "done": true}',
    b'{"stamp": true, "bodies": [], "done": true}',
    b'{"stamp": 20, "bodies": [], "done": 1}',
    b'{"stamp": 20, "bodies": 5, "done": true}',
    b'{"stamp": 20, "bodies": [{"number": 1, "joints": {"head": 3}}], "done": true}',
    b'{"done": true, "stamp": 20, "bodies": [{"number": 1, "joints": {"head": {"position": %s}}}]}'
    % b'[0, 0, NaN]',
]


@pytest.mark.parametrize('damage', DAMAGES, ids=range(len(DAMAGES)))
def test_lines_after_a_damaged_one_are_read_and_the_damaged_file_is_kept(tmp_path, damage) -> None:
    path = tmp_path / 'journal'
    lines = fill(path).splitlines()
    lines[2] = damage
    damaged = b'\n'.join(lines) + b'\n'
    path.write_bytes(damaged)
    aside = tmp_path / 'journal.damaged'
    with opened(path) as journal:
        assert list(journal.frames) == [10, 30]
        expected = '1 of 3 changes cannot be read, and are left out; the damaged file is kept as'
        assert journal.warnings == [f'{path}: {expected} {aside}']
        assert aside.read_bytes() == damaged
        journal.keep(20, labels(5), done=True)
    with opened(path) as journal:
        assert list(journal.frames) == [10, 30, 20]
        assert not journal.warnings
    # Not even a second damaged file replaces the first.
    path.write_bytes(damaged + b'{"torn')
    with opened(path) as journal:
        assert len(journal.warnings) == 2
        assert str(tmp_path / 'journal.damaged-2') in journal.warnings[0]
        assert 'the last change was cut off' in journal.warnings[1]
    assert names_in(tmp_path) == ['journal', 'journal.damaged', 'journal.damaged-2']
    assert aside.read_bytes() == damaged


FOREIGN = [
    b'my own notes',
    b'my own notes\n',
    b'{"a": 1}\n',
    b'\n',
    b'\x89PNG\r\n\x1a\n',
    b'{"format": "lsc_pose annotations of mine"}\n',
    b'{"format": "lsc_pose annotation", "version": 1, "content": "aa"}\n{}\n',
    b'{"format": "lsc_pose annotation", "version"\n{}\n',
]


@pytest.mark.parametrize('content', FOREIGN, ids=range(len(FOREIGN)))
def test_a_file_that_is_no_journal_is_left_alone(tmp_path, content) -> None:
    path = tmp_path / 'notes'
    path.write_bytes(content)
    with pytest.raises(InputError, match='move it away, or name another output'):
        opened(path)
    assert path.read_bytes() == content
    assert names_in(tmp_path) == ['notes']


def test_a_pipe_or_a_folder_is_no_journal(tmp_path) -> None:
    os.mkfifo(tmp_path / 'pipe')
    (tmp_path / 'folder').mkdir()
    for name in ('pipe', 'folder'):
        with pytest.raises(InputError, match='name another output'):
            opened(tmp_path / name)


def test_the_journal_of_another_recording_is_refused(tmp_path) -> None:
    path = tmp_path / 'journal'
    before = fill(path)
    other = BAG._replace(content='bb')
    with pytest.raises(InputError, match=r'the journal of another recording, bag\.mcap'):
        opened(path, other)
    assert path.read_bytes() == before
    # The same recording under another name is the same.
    with opened(path, BAG._replace(name='renamed.mcap')) as journal:
        assert list(journal.frames) == STAMPS


def test_a_recording_is_known_by_its_stamps_and_its_first_and_last_image(simple_frames) -> None:
    content = FrameStore(simple_frames).content
    assert FrameStore(simple_frames, every=4).content == content
    first, middle, last = simple_frames[0], simple_frames[4], simple_frames[-1]
    deeper = [each._replace(depth=each.depth + np.float32(0.01)) for each in (first, last)]
    late = middle._replace(stamp=middle.stamp + 1)
    for other in (
        simple_frames[:-1],
        [deeper[0], *simple_frames[1:]],
        [*simple_frames[:-1], deeper[1]],
        [*simple_frames[:4], late, *simple_frames[5:]],
    ):
        assert FrameStore(other).content != content


def test_a_full_temporary_folder_is_told(simple_frames) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (simple_frames[0].depth.nbytes, limits[1]))
    try:
        with pytest.raises(InputError, match='no temporary file can hold the depth images'):
            FrameStore(simple_frames)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


HOLD = """
import sys
from pathlib import Path
from lsc_pose_ros.annotation.journal_file import JournalFile
file = JournalFile(Path(sys.argv[1]))
print('locked', flush=True)
sys.stdin.read()
"""


def test_one_process_at_a_time_has_a_journal_and_a_killed_one_frees_it(tmp_path) -> None:
    path = tmp_path / 'journal'
    content = fill(path)
    other = subprocess.Popen(
        [sys.executable, '-c', HOLD, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    with other:
        assert other.stdout.readline() == b'locked\n'
        with pytest.raises(InputError, match='is being annotated already'):
            opened(path)
        other.kill()
    with opened(path) as journal:
        assert list(journal.frames) == STAMPS
    assert path.read_bytes() == content


def test_a_repaired_journal_stays_locked(tmp_path) -> None:
    path = tmp_path / 'journal'
    path.write_bytes(fill(path)[:-10])
    with opened(path) as journal:
        assert journal.warnings
        with pytest.raises(InputError, match='is being annotated already'):
            JournalFile(path)


def test_a_file_system_without_locks_is_known(tmp_path, monkeypatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    with closing(JournalFile(tmp_path / 'journal')) as file:
        assert file.is_locked
    monkeypatch.setattr(fcntl, 'flock', fail)
    with closing(JournalFile(tmp_path / 'journal')) as file:
        assert not file.is_locked


def test_a_journal_without_changes_leaves_no_file(tmp_path) -> None:
    with opened(tmp_path / 'journal'):
        pass
    assert names_in(tmp_path) == []


def test_a_change_that_the_disk_has_no_room_for_is_not_there_later(tmp_path) -> None:
    path = tmp_path / 'journal'
    with opened(path) as journal:
        journal.keep(10, labels(1), done=True)
        size = path.stat().st_size
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        # A part of the line can be written, as on a disk that becomes full.
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 20, limits[1]))
        try:
            with pytest.raises(RefusedError, match='the change is not kept') as refused:
                journal.keep(20, labels(2), done=True)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        assert refused.value.reason is Reason.NO_STORAGE
        assert list(journal.frames) == [10]
        assert path.stat().st_size == size
        journal.keep(30, labels(3), done=True)
    with opened(path) as journal:
        assert list(journal.frames) == [10, 30]
        assert not journal.warnings


@pytest.mark.parametrize('is_replaced', [False, True])
def test_a_journal_that_was_taken_away_keeps_nothing_more(tmp_path, is_replaced) -> None:
    path = tmp_path / 'journal'
    with opened(path) as journal:
        journal.keep(10, labels(1), done=True)
        path.unlink()
        if is_replaced:
            path.write_text('of somebody else')
        with pytest.raises(RefusedError, match='Write the recording now'):
            journal.keep(20, labels(2), done=True)
        assert list(journal.frames) == [10]
        journal.remove()
    assert path.exists() == is_replaced


def test_the_journal_is_text_of_one_json_object_a_line(tmp_path) -> None:
    first, *changes = map(json.loads, fill(tmp_path / 'journal').splitlines())
    assert first['format'] == 'lsc_pose annotation'
    assert [change['stamp'] for change in changes] == STAMPS
    joints = changes[1]['bodies'][0]['joints']
    assert joints == {'head': {'position': [0.1, 0.2, 2.0], 'hidden': False}}
