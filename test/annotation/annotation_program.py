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
"""`lsc_pose annotate` as a program of its own, as users start it."""

import atexit
import re
import signal
import subprocess
import sys
from pathlib import Path

# The tests may run in the background, where Ctrl-C is ignored.
MAIN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from lsc_pose_ros.cli.main import main
sys.exit(main())
"""


class AnnotationProgram:
    """The command while it runs.

    Attributes:
        address: of its page.
        begin: what it has printed up to the address.
    """

    def __init__(self, recording: Path, output: Path, *options: str) -> None:
        """Start it and wait for its address."""
        words = [
            'annotate',
            str(recording),
            '-o',
            str(output),
            '--no-browser',
            '--quiet',
            *options,
        ]
        self._process = subprocess.Popen(
            [sys.executable, '-c', MAIN, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        # Not left alone if the test fails.
        atexit.register(self._process.kill)
        self.begin, found = '', None
        while found is None:
            line = self._process.stdout.readline()
            self.begin += line
            assert line, self.begin + self._process.communicate()[1]
            found = re.search(r'http://\S+', line)
        self.address = found.group()

    @property
    def port(self) -> int:
        """The port of the page."""
        return int(re.search(r':(\d+)/', self.address).group(1))

    @property
    def token(self) -> str:
        """The token of the page."""
        return self.address.split('token=')[1]

    def end(self, number: signal.Signals | None = None) -> tuple[int, str, str]:
        """Send a signal, if any, and return status, output and errors."""
        if number is not None:
            self._process.send_signal(number)
        out, err = self._process.communicate()
        atexit.unregister(self._process.kill)
        return self._process.returncode, out, err
