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
"""The server of an annotation answers odd requests with a sentence, and prints nothing."""

import json
import socket
import sys
import threading
from pathlib import Path

import pytest
from waiting import PATIENCE

from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal, RecordingIdentity
from lsc_pose_ros.annotation.journal_file import JournalFile
from lsc_pose_ros.annotation.request_content import LARGEST_REQUEST
from lsc_pose_ros.annotation.server import AnnotationServer
from lsc_pose_ros.annotation.session import Session
from lsc_pose_ros.labels.tracks import skeletons_of

sys.path.insert(0, str(Path(__file__).parent))
from annotation_requests import ask, post, send


@pytest.fixture(scope='module')
def server(simple_frames, tmp_path_factory):
    """A server on ten labelled frames, which has little patience."""
    store = FrameStore(simple_frames)
    file = JournalFile(tmp_path_factory.mktemp('requests') / 'journal')
    identity = RecordingIdentity('bag.mcap', store.content, store.all_stamps)
    session = Session('bag.mcap', store, Journal(file, identity), lambda _: skeletons_of({}))
    with serving(AnnotationServer(session, lambda: '', '', patience=1.0)) as server:
        yield server
    session.close()


class serving:  # noqa: N801 - a context manager
    """Serves until the end of the context."""

    def __init__(self, server: AnnotationServer) -> None:
        self._server = server
        self._thread = threading.Thread(target=server.serve_forever)

    def __enter__(self) -> AnnotationServer:
        self._thread.start()
        return self._server

    def __exit__(self, *error: object) -> None:
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()


@pytest.fixture(autouse=True)
def quiet(server, capfd):
    """Whatever is asked, nothing is printed, and the server goes on."""
    yield
    assert ask(server, 'GET', '/frame/0')[0] == 200
    assert capfd.readouterr() == ('', '')


def error_of(answer: tuple[int, bytes]) -> str:
    """Return the sentence of an answer, which is strict JSON."""
    content = json.loads(answer[1], parse_constant=pytest.fail)
    assert 0 < len(content['error']) < 300
    return content['error']


HUGE = b'1' + b'0' * 400
PIXEL = b'"pixel": [1, 1], '
JOINT = b'"body": 1, "joint": "head"'


@pytest.mark.parametrize(
    'content',
    [
        b'{' + PIXEL + b'"body": Infinity, "joint": "head"}',
        b'{' + PIXEL + b'"body": 1e999, "joint": "head"}',
        b'{' + PIXEL + b'"body": NaN, "joint": "head"}',
        b'{' + PIXEL + b'"body": true, "joint": "head"}',
        b'{' + PIXEL + b'"body": "1", "joint": "head"}',
        b'{' + PIXEL + b'"body": 1, "joint": ["head"]}',
        b'{' + PIXEL + b'"body": 1, "joint": "\\ud800"}',
        b'{' + PIXEL + b'"joint": "head"}',
        b'{"pixel": [NaN, 1], ' + JOINT + b'}',
        b'{"pixel": [1e308, 1], ' + JOINT + b'}',
        b'{"pixel": [-1e999, 1], "depth": 2}',
        b'{"pixel": [' + HUGE + b', 1], ' + JOINT + b'}',
        b'{"pixel": {"a": 1, "b": 2}, ' + JOINT + b'}',
        b'{"pixel": "12", ' + JOINT + b'}',
        b'{"pixel": [true, 1], ' + JOINT + b'}',
        b'{' + PIXEL + b'"depth": ' + HUGE + b'}',
        b'{' + PIXEL + b'"depth": NaN}',
        b'{' + PIXEL + b'"depth": []}',
        b'{' + PIXEL + b'"depth": 2, "more": NaN}',
        b'[' * 100_000,
        b'{"a": ' + b'1' * 5000 + b'}',
        b'\xff\xfe{}',
        b'[]',
        b'',
    ],
)
@pytest.mark.parametrize('path', ['/place/0', '/keep/0'])
def test_odd_contents_are_refused(server, path, content) -> None:
    answer = send(server, post(server, path, content))
    assert answer[0] == 400
    error_of(answer)


@pytest.mark.parametrize(
    'joints',
    [
        b'{"head": {"position": [' + HUGE + b', 0, 1]}}',
        b'{"head": {"position": [1e999, 0, 1]}}',
        b'{"\\ud800": {}}',
        b'[]',
    ],
)
def test_odd_labels_are_refused(server, joints) -> None:
    content = b'{"revision": 0, "bodies": [{"number": 1, "joints": ' + joints + b'}]}'
    answer = send(server, post(server, '/keep/0', content))
    assert answer[0] == 400
    error_of(answer)


@pytest.mark.parametrize(
    ('length', 'status', 'word'),
    [
        (None, 411, 'Content-Length'),
        ('abc', 400, 'Content-Length'),
        ('-1', 400, 'Content-Length'),
        ('1.5', 400, 'Content-Length'),
        ('\xb2', 400, 'Content-Length'),
        (str(LARGEST_REQUEST + 1), 413, 'at most'),
        ('9' * 5000, 413, 'at most'),
    ],
)
@pytest.mark.parametrize('path', ['/place/0', '/keep/0', '/finish'])
def test_odd_lengths_are_refused(server, path, length, status, word) -> None:
    head = post(server, path, b'', length if length != '\xb2' else 'SUPERSCRIPT')
    answer = send(server, head.replace(b'SUPERSCRIPT', b'\xb2'))
    assert answer[0] == status
    assert word in error_of(answer)


def test_a_request_that_ends_early_is_refused(server) -> None:
    answer = send(server, post(server, '/keep/0', b'{}', '100'), ends=True)
    assert answer[0] == 400
    assert error_of(answer) == 'the request ends after 2 of 100 bytes'


def test_a_request_that_does_not_go_on_holds_no_thread(server) -> None:
    answer = send(server, post(server, '/keep/0', b'{}', '100'))
    assert answer[0] == 408
    assert error_of(answer) == 'the request does not end'
    with socket.create_connection(('127.0.0.1', server.port), PATIENCE) as connection:
        connection.sendall(b'GET /frame/0 HT')
        assert connection.recv(1) == b''


@pytest.mark.parametrize('target', ['http://[/', 'http://[/?token=', '//[', 'http://a]b/'])
@pytest.mark.parametrize('method', ['GET', 'POST'])
def test_addresses_that_are_none_are_refused(server, method, target) -> None:
    lines = f'{method} {target} HTTP/1.0', f'Host: 127.0.0.1:{server.port}', '', ''
    assert send(server, '\r\n'.join(lines).encode())[0] in {400, 403}


def test_a_failure_of_the_program_is_told_as_json(server, monkeypatch) -> None:
    def fail() -> None:
        message = 'unforeseen'
        raise LookupError(message)

    monkeypatch.setattr(server.session, 'recording', fail)
    status, answer = ask(server, 'GET', '/recording')
    assert (status, answer) == (500, {'error': 'LookupError: unforeseen'})
