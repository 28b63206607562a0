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

"""Runs long work in a thread, so that the process can be stopped while it runs."""

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TypeVar

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException

Result = TypeVar('Result')

_POLL_PERIOD = 0.05


def run_in_background(work: Callable[[], Result], context: Context) -> Result:
    """Run `work` in a new thread, and return its result or raise its exception.

    The compilation of kernels cannot be interrupted. If the process is told to stop, the thread
    is left alone.

    Args:
        work: the work.
        context: is shut down if the process is told to stop.

    Raises:
        ExternalShutdownException: the process is told to stop; the thread still runs.
    """
    outcome: Future[Result] = Future()

    def run() -> None:
        try:
            outcome.set_result(work())
        except BaseException as error:  # noqa: BLE001 - the caller raises it
            outcome.set_exception(error)

    threading.Thread(target=run, name='background', daemon=True).start()
    while not wait([outcome], _POLL_PERIOD).done:
        if not context.ok():
            raise ExternalShutdownException
    return outcome.result()
