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
"""An annotation is written, and gone on with later."""

import signal
import socket
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from waiting import PATIENCE

from lsc_pose_ros.annotation.server import AnnotationServer
from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from annotation_requests import ask


def request(program, method: str, path: str, content: object = None) -> Any:
    """Return the JSON of an answer."""
    status, answer = ask(program, method, path, content)
    assert status == 200, answer
    return answer


def accept(program, number: int, *, right: float = 0.0) -> None:
    """Say that a frame is done, after its heads are moved to the right by so many metres."""
    frame = request(program, 'GET', f'/frame/{number}')
    for body in frame['bodies']:
        body['joints']['head']['position'][0] += right
    request(program, 'POST', f'/keep/{number}', frame | {'done': True})


def finish(program) -> str:
    """Write the recording, and return the last line of the program."""
    text = request(program, 'POST', '/finish', {})['text']
    status, out, err = program.end()
    assert (status, err) == (0, '')
    assert out.splitlines()[-1] == text
    return text


def labels_in(path: Path):
    """Return the labels of all frames."""
    return [frame.ground_truth for frame in open_recording(path)]


def heads(labels: Skeletons) -> np.ndarray:
    return labels.positions[:, labels.joints == JOINT_NUMBERS['head'], 0].ravel()


def test_an_annotation_goes_on_from_the_recording_that_was_written(labelled, tmp_path) -> None:
    output = tmp_path / 'hand.mcap'
    program = AnnotationProgram(labelled, output, '--every', '3')
    accept(program, 1, right=0.1)  # frame 3
    accept(program, 2, right=0.1)  # frame 6
    assert finish(program) == f'{output}: 10 frames, 2 of them labelled, 2 bodies'
    first = labels_in(output)
    assert [len(each.bodies) for each in first] == [0, 0, 0, 1, 0, 0, 1, 0, 0, 0]

    # Also with other frames than before: those that are not shown keep their labels.
    program = AnnotationProgram(labelled, output, '--every', '2')
    assert f'{output} has labels of 2 of 10 frames; they stay' in program.begin
    assert request(program, 'GET', '/recording')['done'] == [False, False, False, True, False]
    shown = request(program, 'GET', '/frame/3')['bodies'][0]['joints']['head']['position'][0]
    assert shown == pytest.approx(heads(first[6])[0])
    accept(program, 3, right=0.2)  # frame 6
    accept(program, 4)  # frame 8
    assert finish(program) == f'{output}: 10 frames, 3 of them labelled, 3 bodies'
    second = labels_in(output)
    assert [len(each.bodies) for each in second] == [0, 0, 0, 1, 0, 0, 1, 0, 1, 0]
    np.testing.assert_array_equal(second[3].positions, first[3].positions)
    np.testing.assert_array_equal(second[3].visibility, first[3].visibility)
    np.testing.assert_allclose(heads(second[6]), heads(first[6]) + 0.2, atol=1e-6)


def test_an_interrupted_annotation_goes_on_with_other_frames(labelled, tmp_path) -> None:
    output = tmp_path / 'hand.mcap'
    program = AnnotationProgram(labelled, output, '--every', '3')
    accept(program, 1)  # frame 3
    accept(program, 2)  # frame 6
    program.end(signal.SIGINT)
    program = AnnotationProgram(labelled, output, '--every', '2')
    assert request(program, 'GET', '/recording')['done'] == [False, False, False, True, False]
    assert finish(program) == f'{output}: 10 frames, 2 of them labelled, 2 bodies'


@pytest.mark.parametrize('what', ['other stamps', 'other depths', 'fewer', 'more', 'damaged'])
def test_an_output_of_something_else_is_refused(labelled, person, tmp_path, capsys, what) -> None:
    output = tmp_path / 'hand.mcap'
    if what == 'damaged':
        output.write_bytes(labelled.read_bytes()[:100])
    else:
        last = person[-1]
        frames = {
            'other stamps': [*person[:-1], last._replace(stamp=last.stamp + 1000)],
            'other depths': [*person[:-1], last._replace(depth=last.depth + np.float32(0.1))],
            'fewer': person[:-1],
            'more': [*person, last._replace(stamp=last.stamp + 33_000_000)],
        }[what]
        with RecordingWriter(output) as writer:
            for frame in frames:
                writer.write_frame(frame)
    before = output.read_bytes()
    words = ['annotate', str(labelled), '-o', str(output), '--no-browser', '--quiet']
    assert main(words) == 2
    error = capsys.readouterr().err
    assert str(output) in error
    assert 'move it away, or name another output with -o' in error
    assert output.read_bytes() == before


@pytest.fixture
def server():
    """A server whose answer is longer than what a connection holds."""
    with AnnotationServer(None, lambda: 'x' * 40_000_000, '') as server:
        server.daemon_threads = False
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def ask_to_finish(server: AnnotationServer) -> socket.socket:
    """Return a connection on which the answer is under way."""
    connection = socket.create_connection(('127.0.0.1', server.server_port), PATIENCE)
    lines = (
        'POST /finish HTTP/1.0',
        f'Host: 127.0.0.1:{server.server_port}',
        f'X-Token: {server.token}',
        'Content-Length: 2',
    )
    connection.sendall(''.join(f'{line}\r\n' for line in (*lines, '')).encode() + b'{}')
    assert connection.recv(12).endswith(b'200')
    return connection


def test_the_command_ends_after_the_page_was_told(server) -> None:
    with ask_to_finish(server) as connection:
        assert not server.ended.is_set()
        while connection.recv(1_000_000):
            pass
    assert server.ended.wait(PATIENCE)


def test_a_page_that_is_closed_meanwhile_ends_the_command_without_a_word(server, capsys) -> None:
    ask_to_finish(server).close()
    assert server.ended.wait(PATIENCE)
    server.shutdown()
    server.server_close()  # waits for the threads
    assert capsys.readouterr().err == ''
