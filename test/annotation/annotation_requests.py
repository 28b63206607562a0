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
"""Requests to the server of an annotation, as its page sends them."""

import http.client
import json
import socket
from typing import Any

from waiting import PATIENCE


def ask(program: Any, method: str, path: str, content: object = None, **headers: str) -> tuple:
    """Send a request, and return status and JSON, or bytes, of its answer."""
    connection = http.client.HTTPConnection('127.0.0.1', program.port, timeout=PATIENCE)
    body = None if content is None else json.dumps(content)
    connection.request(method, path, body, {'X-Token': program.token} | headers)
    answer = connection.getresponse()
    data = answer.read()
    is_json = answer.getheader('Content-Type') == 'application/json'
    return answer.status, json.loads(data) if is_json else data


def keep(program: Any, number: int, bodies: object, *, done: bool = True) -> tuple:
    """Keep the bodies of a frame as a page that shows its newest labels."""
    revision = ask(program, 'GET', f'/frame/{number}')[1]['revision']
    content = {'bodies': bodies, 'done': done, 'revision': revision}
    return ask(program, 'POST', f'/keep/{number}', content)


def send(program: Any, data: bytes, *, ends: bool = False) -> tuple[int, bytes]:
    """Send bytes, and return status and content of the answer.

    Args:
        program: listens on `port`.
        data: of the request.
        ends: whether the sender says that no more comes.
    """
    with socket.create_connection(('127.0.0.1', program.port), PATIENCE) as connection:
        connection.sendall(data)
        if ends:
            connection.shutdown(socket.SHUT_WR)
        answer = b''
        while part := connection.recv(65_536):
            answer += part
    head, _, content = answer.partition(b'\r\n\r\n')
    return int(head.split()[1]), content


def post(program: Any, path: str, body: bytes, length: str | None = '') -> bytes:
    """Return a POST request; its Content-Length is that of `body`, `length`, or absent if None."""
    lines = [
        f'POST {path} HTTP/1.0',
        f'Host: 127.0.0.1:{program.port}',
        f'X-Token: {program.token}',
    ]
    if length is not None:
        lines.append(f'Content-Length: {length or len(body)}')
    return ''.join(f'{line}\r\n' for line in (*lines, '')).encode() + body
