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

"""Runs the node until it is told to stop."""

import os
import signal
import sys
import threading

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.node import PoseNode

# Seconds after which one thread lets another go on, a tenth of Python's own: the worker, whose
# frame is to be answered, otherwise waits as long for the thread that receives messages. At
# 640x480 and 30 Hz on two busy cores, the 95th percentile of latency was 10.8 ms instead of 11.5
# (three runs each, all of them lower), and the processor's load the same.
_SWITCH_INTERVAL = 0.0005


def run_node(words: list[str] | None = None) -> None:
    """Run the node until SIGINT or SIGTERM.

    Args:
        words: the command line with --ros-args; None for the process's own.

    Raises:
        InputError: an argument, a parameter or the model cannot be used.
    """
    told_to_stop = _note_signals()
    sys.setswitchinterval(_SWITCH_INTERVAL)
    try:
        rclpy.init(args=words)
    except RuntimeError as error:  # what all of rclpy's own errors are
        msg = f'the arguments after --ros-args cannot be read: {error}'
        raise InputError(msg) from error
    try:
        if not told_to_stop:
            _spin()
    except ExternalShutdownException:
        pass  # the ordinary end
    except RuntimeError:
        if rclpy.ok():
            raise
        # Told to stop while it was at something: nothing more can be made of ROS.
    finally:
        rclpy.try_shutdown()
    _leave_threads_behind()


def _spin() -> None:
    node = PoseNode()
    try:
        if node.autostart:
            node.start()
        # One thread is enough: its callbacks only pass messages on to the worker.
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    finally:
        node.close()
        node.destroy_node()


def _note_signals() -> list[int]:
    """Let SIGINT and SIGTERM shut down ROS alone; return where they are noted.

    Python's own KeyboardInterrupt would break off whatever is being done. rclpy, which is started
    afterwards, shuts down its context and then calls these handlers.
    """
    noted: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda which, _frame: noted.append(which))
    return noted


def _leave_threads_behind() -> None:
    """End the process if a thread is still at work.

    It may be compiling kernels, which nothing can interrupt, and which crashes where Python takes
    itself apart underneath.
    """
    if threading.active_count() > 1:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)
