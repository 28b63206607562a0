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
"""Serves the page of an annotation to browsers of this computer.

Other web pages that are open in the browser cannot use it: each request needs the token of the
address that the command prints, and the host name of this computer, so that a foreign name that
leads here (DNS rebinding) is refused.
"""

import json
import secrets
import sys
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from lsc_pose_ros.annotation.session import Session
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource

LOOPBACK = '127.0.0.1'

LARGEST_REQUEST = 1_000_000
"""No request has more bytes."""

_HTML, _SCRIPT, _STYLE = (f'text/{kind}; charset=utf-8' for kind in ('html', 'javascript', 'css'))

_SCRIPTS = (
    'actions', 'annotate', 'drawing', 'frames', 'joints', 'pointer', 'requests', 'state', 'view',
)  # fmt: skip

_FILES = {'/': ('index.html', _HTML), '/annotate.css': ('annotate.css', _STYLE)} | {
    f'/{name}.js': (f'{name}.js', _SCRIPT) for name in _SCRIPTS
}

_COLOURS = '/colours.css'

_POLICY = "default-src 'self'; img-src 'self' blob: data:; frame-ancestors 'none'"


class AnnotationServer(ThreadingHTTPServer):
    """Answers the requests of the page.

    Attributes:
        token: the word that each request must have.
        session: what the page works on.
        finish: is called when the page asks for the labelled recording; returns what to tell.
        colours: the style sheet with the colours of the page.
        summary: what `finish` has returned, empty before.
        ended: is set after the page was told the summary.
    """

    daemon_threads = True

    def __init__(
        self, session: Session, finish: Callable[[], str], colours: str, port: int = 0
    ) -> None:
        """Listen.

        Args:
            session: what the page works on.
            finish: writes the labelled recording.
            colours: the style sheet with the colours of the page.
            port: the port; 0 for any that is free.

        Raises:
            InputError: the port is taken.
        """
        self.token = secrets.token_urlsafe(16)
        self.session, self.finish, self.colours = session, finish, colours
        self.summary, self.ended = '', threading.Event()
        try:
            super().__init__((LOOPBACK, port), _Handler)
        except OSError as error:
            msg = f'port {port} cannot be used ({error.strerror}); give another --port'
            raise InputError(msg) from error

    @property
    def address(self) -> str:
        """The address of the page."""
        return f'http://{LOOPBACK}:{self.server_port}/?token={self.token}'

    def answers_to(self, host: str) -> bool:
        """Return whether a request's host name is one of this computer."""
        return host in {f'{name}:{self.server_port}' for name in (LOOPBACK, 'localhost')}

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Say nothing of a page that was closed before it had its answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: AnnotationServer

    def do_GET(self) -> None:
        """Send a file, a frame, or a picture."""
        path = urlsplit(self.path).path
        if not self._is_allowed(path):
            return
        session = self.server.session
        if path in _FILES:
            name, kind = _FILES[path]
            self._send(resource('annotate', name).read_bytes(), kind)
        elif path == _COLOURS:
            self._send(self.server.colours.encode(), _STYLE)
        elif path == '/recording':
            self._answer(session.recording)
        elif path.startswith('/frame/'):
            self._answer(lambda: session.frame(_number(path)))
        elif path.startswith('/depth/'):
            self._answer(lambda: session.picture(_number(path)))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Place a joint, keep a frame, or finish."""
        path = urlsplit(self.path).path
        if not self._is_allowed(path):
            return
        actions: dict[str, Callable[[int, dict[str, Any]], object]] = {
            '/place/': self._place,
            '/keep/': self._keep,
        }
        if path == '/finish':
            self._finish()
            return
        for beginning, action in actions.items():
            if path.startswith(beginning):
                self._answer(lambda: action(_number(path), self._content()))  # noqa: B023
                return
        self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing."""

    def _finish(self) -> None:
        def finish() -> dict[str, str]:
            self.server.summary = self.server.finish()
            return {'text': self.server.summary}

        try:
            self._answer(finish)
        finally:  # even if the page was closed meanwhile
            if self.server.summary:
                self.server.ended.set()

    def _place(self, number: int, content: dict[str, Any]) -> dict[str, Any]:
        session = self.server.session
        try:
            column, row = (float(value) for value in content['pixel'])
            if content.get('depth') is not None:
                return session.at_depth(number, (column, row), float(content['depth']))
            joint = str(content['joint'])
            return session.place(number, int(content['body']), joint, (column, row))
        except (KeyError, TypeError, ValueError) as error:
            msg = 'a joint is placed by pixel, body and joint, or by pixel and depth'
            raise InputError(msg) from error

    def _keep(self, number: int, content: dict[str, Any]) -> dict[str, Any]:
        bodies, done = content.get('bodies'), content.get('done') is True
        if not isinstance(bodies, list):
            msg = 'a frame is kept with its bodies'
            raise InputError(msg)
        return self.server.session.keep(number, bodies, done=done)

    def _is_allowed(self, path: str) -> bool:
        """Return whether the request may be answered; else refuse it."""
        given = parse_qs(urlsplit(self.path).query).get('token', [''])[0]
        given = given or self.headers.get('X-Token', '')
        # Scripts and styles have no secret, and the page asks for them without the token.
        known = path == _COLOURS or (path in _FILES and path != '/')
        known = known or secrets.compare_digest(given.encode(), self.server.token.encode())
        if known and self.server.answers_to(self.headers.get('Host', '')):
            return True
        self.send_error(HTTPStatus.FORBIDDEN, 'Use the address that lsc_pose annotate prints')
        return False

    def _content(self) -> dict[str, Any]:
        length = int(self.headers.get('Content-Length') or 0)
        if not 0 < length <= LARGEST_REQUEST:
            msg = f'a request has 1 to {LARGEST_REQUEST} bytes'
            raise InputError(msg)
        try:
            content = json.loads(self.rfile.read(length))
        except ValueError as error:
            msg = 'the request is no JSON'
            raise InputError(msg) from error
        if not isinstance(content, dict):
            msg = 'the request is no JSON object'
            raise InputError(msg)
        return content

    def _answer(self, answer: Callable[[], object]) -> None:
        try:
            result = answer()
        except InputError as error:
            content = json.dumps({'error': str(error)}).encode()
            self._send(content, 'application/json', HTTPStatus.BAD_REQUEST)
            return
        if isinstance(result, bytes):
            self._send(result, 'image/png')
        else:
            self._send(json.dumps(result).encode(), 'application/json')

    def _send(self, content: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        self.send_response(status)
        for name, value in (
            ('Content-Type', kind),
            ('Content-Length', str(len(content))),
            ('Cache-Control', 'no-store'),
            ('Content-Security-Policy', _POLICY),
            ('X-Content-Type-Options', 'nosniff'),
            ('Referrer-Policy', 'no-referrer'),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)


def _number(path: str) -> int:
    """Return the number at the end of a path.

    Raises:
        InputError: there is none.
    """
    word = path.rsplit('/', 1)[1]
    if not (word.isascii() and word.isdigit() and len(word) < 10):
        msg = 'the address has no number of a frame'
        raise InputError(msg)
    return int(word)
