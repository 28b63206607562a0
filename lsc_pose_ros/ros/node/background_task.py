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

"""Runs long work in a thread, while the node answers its services and can be stopped."""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import TypeVar

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

Result = TypeVar('Result')

_POLL_PERIOD = 0.05


def run_in_background(work: Callable[[], Result], node: Node) -> Result:
    """Run `work` in a new thread, and return its result or raise its exception.

    Meanwhile `node` is served by an executor of its own, because this may be called by a callback
    of its executor. So the callback groups of the node must be reentrant.

    The compilation of kernels cannot be interrupted. If the process is told to stop, the thread
    is left alone.

    Args:
        work: the work; it must not change the node.
        node: the node that is served while this function waits.

    Raises:
        ExternalShutdownException: the process is told to stop; the thread still runs.
    """
    outcome: Future[Result] = Future()
    with _served_meanwhile(node) as executor:
        threading.Thread(target=_run, args=(work, outcome), name='background', daemon=True).start()
        while not outcome.done():
            executor.spin_once(timeout_sec=_POLL_PERIOD)
    try:
        return outcome.result()
    finally:
        del outcome  # an exception would refer to itself by its traceback and this variable


def _run(work: Callable[[], Result], outcome: Future[Result]) -> None:
    try:
        outcome.set_result(work())
    except BaseException as error:  # noqa: BLE001 - the caller raises it
        outcome.set_exception(error)
        del outcome  # as in `run_in_background`


@contextmanager
def _served_meanwhile(node: Node) -> Iterator[SingleThreadedExecutor]:
    """Give `node` to a new executor, and give it back at the end."""
    before = node.executor
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)  # removes it from the one before
    try:
        yield executor
    finally:
        executor.remove_node(node)
        if before is not None:
            before.add_node(node)
        executor.shutdown()
