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

from lsc_pose_ros.annotation.refusals import Reason, RefusedError
from lsc_pose_ros.annotation.request_content import (
    RequestError,
    frame_number,
    joint_request,
    read_content,
)
from lsc_pose_ros.annotation.session import Session
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource

LOOPBACK = '127.0.0.1'

_STATUS = {
    Reason.STALE: HTTPStatus.CONFLICT,
    Reason.BEING_WRITTEN: HTTPStatus.LOCKED,
    Reason.ENDED: HTTPStatus.GONE,
    Reason.NO_STORAGE: HTTPStatus.INSUFFICIENT_STORAGE,
}

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
        patience: how long a page may be silent within a request, seconds.
        summary: what `finish` has returned, empty before.
        ended: is set after the page was told the summary.
    """

    daemon_threads = True

    def __init__(
        self,
        session: Session,
        finish: Callable[[], str],
        colours: str,
        port: int = 0,
        patience: float = 30.0,
    ) -> None:
        """Listen.

        Args:
            session: what the page works on.
            finish: writes the labelled recording.
            colours: the style sheet with the colours of the page.
            port: the port; 0 for any that is free.
            patience: how long a page may be silent within a request, seconds.

        Raises:
            InputError: the port is taken.
        """
        self.token = secrets.token_urlsafe(16)
        self.session, self.finish, self.colours = session, finish, colours
        self.patience, self.summary, self.ended = patience, '', threading.Event()
        try:
            super().__init__((LOOPBACK, port), _Handler)
        except OSError as error:
            msg = f'port {port} cannot be used ({error.strerror}); give another --port'
            raise InputError(msg) from error

    @property
    def port(self) -> int:
        """The port."""
        return self.server_port

    @property
    def address(self) -> str:
        """The address of the page."""
        return f'http://{LOOPBACK}:{self.port}/?token={self.token}'

    def answers_to(self, host: str) -> bool:
        """Return whether a request's host name is one of this computer."""
        return host in {f'{name}:{self.port}' for name in (LOOPBACK, 'localhost')}

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Say nothing of a page that was closed before it had its answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: AnnotationServer

    def setup(self) -> None:
        """Set the time limit of the connection."""
        super().setup()
        self.connection.settimeout(self.server.patience)

    def do_GET(self) -> None:
        """Send a file, a frame, or a picture."""
        path = self._allowed_path()
        session = self.server.session
        if path is None:
            return
        if path in _FILES:
            name, kind = _FILES[path]
            self._send(resource('annotate', name).read_bytes(), kind)
        elif path == _COLOURS:
            self._send(self.server.colours.encode(), _STYLE)
        elif path == '/recording':
            self._answer(session.recording)
        elif path.startswith('/frame/'):
            self._answer(lambda: session.frame(frame_number(path)))
        elif path.startswith('/depth/'):
            self._answer(lambda: session.picture(frame_number(path)))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Place a joint, keep a frame, or finish."""
        path = self._allowed_path()
        if path is None:
            return
        if path == '/finish':
            self._finish()
        elif path.startswith('/place/'):
            self._answer(lambda: self._place(frame_number(path), self._content()))
        elif path.startswith('/keep/'):
            self._answer(lambda: self._keep(frame_number(path), self._content()))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing."""

    def _content(self) -> dict[str, object]:
        return read_content(self.headers, self.rfile)

    def _finish(self) -> None:
        summary = ''

        def finish() -> dict[str, str]:
            nonlocal summary
            self._content()
            summary = self.server.summary = self.server.finish()
            return {'text': summary}

        try:
            self._answer(finish)
        finally:  # even if the page was closed meanwhile
            if summary:
                self.server.ended.set()

    def _place(self, number: int, content: dict[str, object]) -> dict[str, Any]:
        session, wanted = self.server.session, joint_request(content)
        if wanted.depth is not None:
            return session.at_depth(number, wanted.pixel, wanted.depth)
        return session.place(number, wanted.body, wanted.joint, wanted.pixel)

    def _keep(self, number: int, content: dict[str, object]) -> dict[str, Any]:
        return self.server.session.keep(
            number,
            content.get('bodies'),
            done=content.get('done') is True,
            revision=content.get('revision'),
        )

    def _allowed_path(self) -> str | None:
        """Return the path of the address, None if the request is refused."""
        try:
            parts = urlsplit(self.path)
            given = parse_qs(parts.query).get('token', [''])[0]
        except ValueError:
            self.send_error(HTTPStatus.BAD_REQUEST, 'This is no address')
            return None
        return parts.path if self._is_allowed(parts.path, given) else None

    def _is_allowed(self, path: str, given: str) -> bool:
        """Return whether the request may be answered; else refuse it."""
        given = given or self.headers.get('X-Token', '')
        # Scripts and styles have no secret, and the page asks for them without the token.
        known = path == _COLOURS or (path in _FILES and path != '/')
        known = known or secrets.compare_digest(given.encode(), self.server.token.encode())
        if known and self.server.answers_to(self.headers.get('Host', '')):
            return True
        self.send_error(HTTPStatus.FORBIDDEN, 'Use the address that lsc_pose annotate prints')
        return False

    def _answer(self, answer: Callable[[], object]) -> None:
        status = HTTPStatus.OK
        try:
            content, kind = _encoded(answer())
        except ConnectionError:
            raise
        except Exception as error:  # noqa: BLE001 - the last resort: the page shows it
            status, text = _refusal(error)
            content, kind = _encoded({'error': text})
        self._send(content, kind, status)

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


def _encoded(answer: object) -> tuple[bytes, str]:
    """Return the content and the kind of an answer: a picture, or anything else as JSON."""
    if isinstance(answer, bytes):
        return answer, 'image/png'
    return json.dumps(answer, allow_nan=False).encode(), 'application/json'


def _refusal(error: Exception) -> tuple[HTTPStatus, str]:
    """Return the status and the sentence for what went wrong."""
    if isinstance(error, RequestError):
        return error.status, str(error)
    if isinstance(error, RefusedError):
        return _STATUS[error.reason], str(error)
    if isinstance(error, InputError):
        return HTTPStatus.BAD_REQUEST, str(error)
    if isinstance(error, TimeoutError):
        return HTTPStatus.REQUEST_TIMEOUT, 'the request does not end'
    return HTTPStatus.INTERNAL_SERVER_ERROR, f'{type(error).__name__}: {error}'
