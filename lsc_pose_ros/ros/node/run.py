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

"""Runs the node until the process is told to stop."""

import os
import signal
import sys
import threading

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.node import PoseNode

# Seconds after which Python switches to another thread, a tenth of its default: otherwise the
# worker, which has a frame to estimate, waits longer for the thread that receives messages. At
# 640x480 and 30 Hz on two busy cores, the 95th percentile of the latency was 10.8 ms instead of
# 11.5 (lower in each of three runs), with the same load of the processor.
_SWITCH_INTERVAL = 0.0005


def run_node(words: list[str]) -> None:
    """Run the node until SIGINT or SIGTERM.

    Args:
        words: the command line without the program.

    Raises:
        InputError: an argument, a parameter or the model cannot be used.
    """
    received_signals = _record_signals()
    sys.setswitchinterval(_SWITCH_INTERVAL)
    try:
        rclpy.init(args=words)
    except RuntimeError as error:  # the base class of rclpy's own errors
        msg = f'the arguments after --ros-args cannot be read: {error}'
        raise InputError(msg) from error
    try:
        if not received_signals:
            _spin()
    except ExternalShutdownException:
        pass  # the normal end
    except RuntimeError:
        if rclpy.ok():
            raise
        # The process was told to stop while it used ROS, which then raises errors.
    finally:
        rclpy.try_shutdown()
        _ignore_signals()
    _exit_despite_threads()


def _spin() -> None:
    node = PoseNode()
    try:
        if node.autostart:
            node.start()
        # One thread is enough: its callbacks only hand messages to the worker.
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    finally:
        node.close()
        node.destroy_node()


def _record_signals() -> list[int]:
    """Make SIGINT and SIGTERM shut down only ROS; return the list of the received signals.

    Python's own KeyboardInterrupt would interrupt any code. rclpy, which is initialised later,
    shuts down its context and then calls these handlers.
    """
    received: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda which, _frame: received.append(which))
    return received


def _ignore_signals() -> None:
    """Ignore SIGINT and SIGTERM while the process ends.

    The interpreter replaces other handlers by the default ones when it is finalised, so that one
    more signal, from an impatient user, would change the exit status.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


def _exit_despite_threads() -> None:
    """End the process if a thread still runs.

    The thread may be compiling kernels, which cannot be interrupted and which crashes when the
    interpreter is finalised.
    """
    if threading.active_count() > 1:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)
