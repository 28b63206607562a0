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

"""Holds SIGINT while a kernel runs.

numba converts the results of a kernel to Python objects without a check for exceptions. A
KeyboardInterrupt that is raised there ends the process with a segmentation fault.
"""

# The functions of `signal` convert to enums, which takes 20 times as long as the change itself.
import _signal  # type: ignore[import-not-found]
import sys
import threading
from types import FrameType
from typing import Any

from numba.core.registry import CPUDispatcher


class InterruptSafeDispatcher(CPUDispatcher):
    """A kernel that Ctrl-C does not interrupt: KeyboardInterrupt is raised when it has returned.

    Only Python's own handler is replaced, and only in the main thread, where it runs. With rclpy
    nothing is replaced, because its handler in C would be lost; its nodes run kernels in other
    threads.
    """

    def __call__(self, *arguments: Any, **named: Any) -> Any:  # noqa: ANN401
        """Run the kernel; it is compiled before SIGINT is held, because that takes seconds."""
        if not _can_hold():
            return super().__call__(*arguments, **named)
        if not self.overloads and len(arguments) == self.py_func.__code__.co_argcount:
            self.compile(tuple(map(self.typeof_pyval, arguments)))
        held = _HeldInterrupt()
        _signal.signal(_signal.SIGINT, held)
        try:
            return super().__call__(*arguments, **named)
        finally:
            _signal.signal(_signal.SIGINT, _signal.default_int_handler)
            if held.arrived:
                raise KeyboardInterrupt


class _HeldInterrupt:
    """A handler that remembers that the signal arrived."""

    def __init__(self) -> None:
        self.arrived = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        """Note the signal."""
        self.arrived = True


def _can_hold() -> bool:
    return (
        threading.get_ident() == threading.main_thread().ident
        and _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler
        and 'rclpy' not in sys.modules
    )
