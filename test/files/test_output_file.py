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

"""A file appears whole, or what was there before stays."""

import io
import os
import resource
import signal
import stat
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import HTML, JSON, PNG, TEXT, archive
from lsc_pose_ros.files.output_file import OutputFile, OutputFolder, write_output
from lsc_pose_ros.files.output_place import check_folder_of_outputs, check_output

MANY = 4 << 20


def only(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_new_file_has_the_rights_of_a_new_file(tmp_path):
    write_output(tmp_path / 'a.json', JSON, b'{}')
    (tmp_path / 'b').touch()
    assert (tmp_path / 'a.json').read_bytes() == b'{}'
    assert (tmp_path / 'a.json').stat().st_mode == (tmp_path / 'b').stat().st_mode
    assert only(tmp_path) == ['a.json', 'b']


def test_rights_of_a_replaced_file_stay(tmp_path):
    path = tmp_path / 'a.json'
    path.write_bytes(b'{"old": 1}')
    path.chmod(0o640)
    assert write_output(path, JSON, b'{}') == 2
    assert path.read_bytes() == b'{}'
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_other_kind_is_not_replaced(tmp_path):
    path = tmp_path / 'a.json'
    path.write_bytes(b'\x89PNG\r\n\x1a\n...')
    with pytest.raises(InputError, match=r'a\.json exists and is not a JSON file'):
        write_output(path, JSON, b'{}')
    write_output(path, PNG, b'\x89PNG\r\n\x1a\nnew')
    assert path.read_bytes().endswith(b'new')


def test_other_kind_that_appears_meanwhile_is_not_replaced(tmp_path):
    path = tmp_path / 'a.json'
    with pytest.raises(InputError, match='not a JSON file'), OutputFile(path, JSON) as stream:  # noqa: PT012
        stream.write(b'{}')
        path.write_bytes(b'precious')
    assert path.read_bytes() == b'precious'
    assert only(tmp_path) == ['a.json']


def test_empty_file_is_replaced(tmp_path):
    (tmp_path / 'a.json').touch()
    write_output(tmp_path / 'a.json', JSON, b'{}')
    assert (tmp_path / 'a.json').read_bytes() == b'{}'


@pytest.mark.parametrize(
    ('kind', 'good', 'bad'),
    [
        (JSON, b'\n {"a": 1}', b'a: 1'),
        (HTML, b'<!DOCTYPE html>', b'<svg>'),
        (TEXT, 'Öl,\n'.encode() * 1365 + b'e', b'\0\1'),
        (TEXT, ('ö' * 4096).encode(), b'\xff\xfe'),
        (archive('a model', 'header.npy'), None, b'PK\3\4 but no archive'),
    ],
)
def test_kinds_are_told_by_the_content(tmp_path, kind, good, bad):
    path = tmp_path / 'file'
    path.write_bytes(bad)
    with pytest.raises(InputError, match=f'is not {kind.name}'):
        check_output(path, kind)
    if good:
        path.write_bytes(good)
        check_output(path, kind)


def test_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / 'data').mkdir()
    target, link = tmp_path / 'data' / 'a.json', tmp_path / 'link.json'
    target.write_bytes(b'{"old": 1}')
    link.symlink_to(Path('data') / 'a.json')
    write_output(link, JSON, b'{}')
    assert link.is_symlink()
    assert target.read_bytes() == b'{}'
    assert only(tmp_path / 'data') == ['a.json']


def test_target_of_a_dangling_link_is_made(tmp_path):
    (tmp_path / 'link.json').symlink_to('later.json')
    write_output(tmp_path / 'link.json', JSON, b'{}')
    assert (tmp_path / 'link.json').is_symlink()
    assert (tmp_path / 'later.json').read_bytes() == b'{}'


def test_links_in_a_circle_are_refused(tmp_path):
    (tmp_path / 'a').symlink_to('b')
    (tmp_path / 'b').symlink_to('a')
    with pytest.raises(InputError, match='a: cannot be written'):
        write_output(tmp_path / 'a', JSON, b'{}')
    assert only(tmp_path) == ['a', 'b']


def test_device_stays_a_device(tmp_path):
    (tmp_path / 'null.json').symlink_to('/dev/null')
    for path in (Path('/dev/null'), tmp_path / 'null.json'):
        write_output(path, JSON, b'{}')
    assert stat.S_ISCHR(Path('/dev/null').stat().st_mode)
    assert (tmp_path / 'null.json').is_symlink()


@pytest.mark.skipif(not Path('/dev/full').exists(), reason='no /dev/full here')
def test_full_device_is_reported():
    with pytest.raises(InputError, match='/dev/full: cannot be written: No space left'):
        write_output(Path('/dev/full'), JSON, b'{}')


def test_pipe_is_written_to(tmp_path):
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()))
    reader.start()
    write_output(path, JSON, b'{}')
    reader.join()
    assert read == [b'{}']
    assert stat.S_ISFIFO(path.stat().st_mode)


def test_pipe_whose_reader_leaves_raises_as_any_pipe(tmp_path):
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    with pytest.raises(BrokenPipeError), OutputFile(path, JSON) as stream:  # noqa: PT012
        os.close(reader)
        stream.write(b'{}')


@pytest.mark.parametrize('name', ['-', '/dev/stdout', '/dev/fd/1', '/proc/self/fd/1'])
def test_standard_output(tmp_path, capfd, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    assert write_output(Path(name), JSON, b'{}') == 2
    assert capfd.readouterr().out == '{}'
    assert only(tmp_path) == []


@pytest.fixture
def arrays():
    return {'a': np.arange(1000), 'b': np.ones((3, 4), np.float32)}


@pytest.mark.parametrize('save', [np.savez, np.savez_compressed])
def test_archive_on_standard_output_can_be_read(capfdbinary, arrays, save):
    size = write_output(Path('-'), TEXT, lambda stream: save(stream, **arrays))
    written = capfdbinary.readouterr().out
    assert len(written) == size
    with np.load(io.BytesIO(written)) as stored:
        for name, array in arrays.items():
            np.testing.assert_array_equal(stored[name], array)


@pytest.mark.parametrize('save', [np.savez, np.savez_compressed])
def test_archive_through_a_pipe_can_be_read(tmp_path, arrays, save):
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()))
    reader.start()
    write_output(path, TEXT, lambda stream: save(stream, **arrays))
    reader.join()
    with np.load(io.BytesIO(read[0])) as stored:
        assert set(stored) == set(arrays)


def test_archive_to_a_device(arrays):
    assert write_output(Path('/dev/null'), TEXT, lambda stream: np.savez(stream, **arrays)) > 0


@pytest.mark.parametrize('name', ['-', '/dev/stdout', '/dev/fd/1'])
def test_file_behind_standard_output_is_appended_to(tmp_path, name):
    """What the shell has opened with >> is not sought, whatever the writer does."""
    shown = tmp_path / 'shown'
    shown.write_bytes(b'before ')
    ended = subprocess.run(
        ['/bin/sh', '-c', f'{sys.executable} -c "$0" "$1" >> "$2"', _SEEKING, name, str(shown)],
        check=False,
    )
    assert ended.returncode == 0
    assert shown.read_bytes() == b'before {}'


_SEEKING = """
import sys
from contextlib import suppress
from pathlib import Path
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import OutputFile
with OutputFile(Path(sys.argv[1]), JSON) as stream:
    stream.write(b'{')
    assert not stream.seekable()
    for change in (lambda: stream.seek(0), lambda: stream.truncate(0)):
        with suppress(OSError):
            change()
            raise AssertionError
    assert stream.tell() == 1
    stream.write(b'}')
"""


@pytest.mark.parametrize('name', ['/dev/fd/{}', '/proc/self/fd/{}'])
def test_descriptor_that_is_closed_or_only_read_is_refused_before_the_work(tmp_path, name):
    (tmp_path / 'read').touch()
    words = 'is closed; name a file instead'
    with (tmp_path / 'read').open('rb') as stream, pytest.raises(InputError, match=words):
        check_output(Path(name.format(stream.fileno())), JSON)
    with pytest.raises(InputError, match=words):
        check_output(Path(name.format(10**6)), JSON)
    with pytest.raises(InputError, match=words):
        check_output(Path(name.format('9' * 30)), JSON)


def test_error_while_it_is_written_keeps_the_old_file(tmp_path):
    path = tmp_path / 'a.json'
    path.write_bytes(b'{"old": 1}')
    with pytest.raises(ZeroDivisionError), OutputFile(path, JSON) as stream:  # noqa: PT012
        stream.write(b'{')
        raise ZeroDivisionError
    assert path.read_bytes() == b'{"old": 1}'
    assert only(tmp_path) == ['a.json']


@pytest.mark.parametrize('size', [MANY, 10])
def test_full_disk_keeps_the_old_file(tmp_path, size):
    """A limit on the size of files stands for a full disk; the last bytes fail at the flush."""
    path = tmp_path / 'a.json'
    path.write_bytes(b'{"old": 1}')
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (min(size, MANY) // 2, before[1]))
    try:
        with pytest.raises(InputError, match=r'a\.json: cannot be written: File too large'):
            write_output(path, JSON, b'{' * size)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b'{"old": 1}'
    assert only(tmp_path) == ['a.json']


_KILLED = """
import os, signal, sys
from pathlib import Path
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import OutputFile
with OutputFile(Path(sys.argv[1]), JSON) as stream:
    stream.write(b'{' * 100000)
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_killed_writer_leaves_the_old_file(tmp_path):
    path = tmp_path / 'a.json'
    path.write_bytes(b'{"old": 1}')
    ended = subprocess.run([sys.executable, '-c', _KILLED, str(path)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert path.read_bytes() == b'{"old": 1}'
    write_output(path, JSON, b'{}')
    assert path.read_bytes() == b'{}'


_INTERRUPTED = """
import sys
from pathlib import Path
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import OutputFile

class Interrupted(OutputFile):
    def __exit__(self, *_):
        raise KeyboardInterrupt

with Interrupted(Path(sys.argv[1]), JSON) as stream:
    stream.write(b'{')
"""


def test_interrupt_of_the_cleaning_up_leaves_nothing(tmp_path):
    path = tmp_path / 'a.json'
    ended = subprocess.run(
        [sys.executable, '-c', _INTERRUPTED, str(path)], check=False, capture_output=True
    )
    assert ended.returncode != 0
    assert only(tmp_path) == []


def test_two_writers_of_one_file_write_it_whole(tmp_path):
    path = tmp_path / 'a.json'
    with OutputFile(path, JSON) as first, OutputFile(path, JSON) as second:
        first.write(b'{' * 100_000)
        second.write(b'[' * 50_000)
        first.write(b'{' * 100_000)
    assert path.read_bytes() == b'{' * 200_000
    assert only(tmp_path) == ['a.json']


def test_write_protected_file_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / 'a.json'
    path.write_bytes(b'{"old": 1}')
    path.chmod(0o444)
    if os.access(path, os.W_OK):  # the super-user may write everything
        monkeypatch.setattr(os, 'access', lambda *_: False)
    with pytest.raises(InputError, match='write-protected'):
        write_output(path, JSON, b'{}')
    assert path.read_bytes() == b'{"old": 1}'


@pytest.mark.parametrize('name', ['a' * 250 + '.json', 'ü' * 127 + 'a', '\U0001f600' * 63 + 'abc'])
def test_longest_name(tmp_path, name):
    """255 bytes, whatever the characters; a name of so many is legal."""
    path = tmp_path / name
    assert len(os.fsencode(name)) == 255
    for text in (b'{}', b'{"new": 1}'):
        write_output(path, JSON, text)
        assert path.read_bytes() == text
    with OutputFolder(tmp_path / ('b' + name[1:])) as folder:
        (folder / 'file').touch()
    assert len(only(tmp_path)) == 2


def test_name_that_is_too_long_is_refused_before_the_work(tmp_path):
    for path in (tmp_path / ('a' * 300), tmp_path / ('ü' * 128), tmp_path / ('a/' * 3000)):
        with pytest.raises(InputError, match='File name too long'):
            check_output(path, JSON)
        with pytest.raises(InputError, match='File name too long'):
            OutputFolder(path)
        with pytest.raises(InputError, match='File name too long'):
            check_folder_of_outputs(path)
    with pytest.raises(InputError, match='File name too long'):
        check_folder_of_outputs(tmp_path / 'missing' / ('a' * 300))


def test_folder_that_cannot_be_written_is_refused_before_the_work(tmp_path, monkeypatch):
    (tmp_path / 'old.json').write_bytes(b'{}')
    tmp_path.chmod(0o555)
    if os.access(tmp_path, os.W_OK):  # the super-user may write everything
        allowed = os.access
        monkeypatch.setattr(
            os, 'access', lambda path, mode: path != tmp_path and allowed(path, mode)
        )
    words = 'the folder .* cannot be written'
    for name in ('new.json', 'old.json'):
        with pytest.raises(InputError, match=words):
            check_output(tmp_path / name, JSON)
    with pytest.raises(InputError, match=words):
        OutputFolder(tmp_path / 'bag')
    for path in (tmp_path, tmp_path / 'report', tmp_path / 'many' / 'folders'):
        with pytest.raises(InputError, match=words):
            check_folder_of_outputs(path)
    tmp_path.chmod(0o755)


def test_folder_of_outputs_may_exist_or_be_made(tmp_path):
    (tmp_path / 'file').touch()
    check_folder_of_outputs(tmp_path)
    check_folder_of_outputs(tmp_path / 'many' / 'folders')
    for path in (tmp_path / 'file', tmp_path / 'file' / 'report'):
        with pytest.raises(InputError, match='file is no folder'):
            check_folder_of_outputs(path)


@pytest.mark.parametrize(
    ('name', 'words'), [('missing/a.json', 'does not exist'), ('folder', 'is a folder')]
)
def test_places_without_room_for_a_file(tmp_path, name, words):
    (tmp_path / 'folder').mkdir()
    with pytest.raises(InputError, match=words):
        write_output(tmp_path / name, JSON, b'{}')


def test_folder_appears_at_the_end(tmp_path):
    with OutputFolder(tmp_path / 'bag') as folder:
        (folder / 'file').write_bytes(b'x')
        assert not (tmp_path / 'bag').exists()
    assert only(tmp_path) == ['bag']
    assert only(tmp_path / 'bag') == ['file']


def test_error_removes_the_folder(tmp_path):
    with pytest.raises(ZeroDivisionError), OutputFolder(tmp_path / 'bag') as folder:  # noqa: PT012
        (folder / 'file').write_bytes(b'x')
        raise ZeroDivisionError
    assert only(tmp_path) == []


def test_folder_that_appears_meanwhile_stays(tmp_path):
    words = 'bag: cannot be written: (Directory not empty|File exists)'
    with pytest.raises(InputError, match=words), OutputFolder(tmp_path / 'bag') as folder:  # noqa: PT012
        (folder / 'file').write_bytes(b'x')
        (tmp_path / 'bag').mkdir()
        (tmp_path / 'bag' / 'mine').write_bytes(b'y')
    assert only(tmp_path) == ['bag']
    assert only(tmp_path / 'bag') == ['mine']
