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

"""Ctrl-C at any moment raises KeyboardInterrupt, and the process survives."""

import signal
import subprocess
import sys
import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel


class Doubled(NamedTuple):
    values: NDArray[np.float64]
    first: float


@kernel
def double(values: NDArray[np.float64]) -> Doubled:
    return Doubled(values * 2, values[0])


_SIGNALS = 400

_LOOP = f"""
import os, random, signal, sys, threading, time
import numpy as np
from test_interrupts import double

# A program that a shell started in the background ignores SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)
values = np.ones(3)
double(values)
sent = threading.Event()

def send():
    for _ in range({_SIGNALS}):
        time.sleep(random.random() * 0.002)
        os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.1)
    sent.set()

sender = threading.Thread(target=send, daemon=True)
interrupts = 0
sender.start()
while not sent.is_set():
    try:
        while not sent.is_set():
            double(values)
    except KeyboardInterrupt:
        interrupts += 1
print(interrupts)
"""


def test_hundreds_of_signals_in_a_loop_over_a_kernel() -> None:
    done = subprocess.run(
        [sys.executable, '-c', f'import sys; sys.path.insert(0, {__file__.rpartition("/")[0]!r})'
         + _LOOP],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    # On a busy computer, several signals arrive as one.
    assert int(done.stdout) > 0


def test_the_handler_is_the_same_after_a_call() -> None:
    before = signal.getsignal(signal.SIGINT)
    assert double(np.ones(2)).first == 1
    assert signal.getsignal(signal.SIGINT) is before


def test_another_handler_is_left_alone() -> None:
    calls: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: calls.append(number))
    try:
        double(np.ones(2))
        signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert calls == [signal.SIGINT]


def test_kernels_run_in_other_threads() -> None:
    found: list[float] = []
    thread = threading.Thread(target=lambda: found.append(double(np.ones(2)).first))
    thread.start()
    thread.join()
    assert found == [1]
