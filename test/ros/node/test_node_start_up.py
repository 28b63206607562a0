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

"""The node's start: how soon it answers once the kernels are kept on disk, and being stopped."""

import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Camera, Program, PublishedEstimates

from lsc_pose_ros.estimation.warm_up import warm_up
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.numerics.kernel_cache import cache_directory, describe_cache
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

# Seconds: ten times what is promised.
MOST_FOR_FIRST_FRAME = 20.0

# The node with a warm-up that takes long, as where nothing is kept yet.
SLOW_START = """
import sys
import time

from lsc_pose_ros.ros.node import preparation
from lsc_pose_ros.ros.node.main import main

def compile_slowly(estimator):
    print('compiling', flush=True)
    for _ in range(20):
        time.sleep(0.1)
    return warm_up(estimator)

warm_up, preparation.warm_up = preparation.warm_up, compile_slowly
sys.exit(main())
"""


# Libraries that the node does not need with the transport raw.
UNNEEDED = {'PIL', 'lz4', 'matplotlib', 'mcap', 'rosbags', 'sqlite3', 'yaml', 'zstandard'}

LOADED = f"""
import sys

import rclpy.lifecycle

loaded_by_rclpy = set(sys.modules)  # has yaml

import lsc_pose_ros.ros.node.run

print(*({UNNEEDED} & sys.modules.keys() - loaded_by_rclpy))
"""


def test_node_loads_no_bag_library(start_program: Callable[..., Program]) -> None:
    program = start_program('-c', LOADED)
    assert program.exit_status() == 0, program.output
    assert program.output.strip() == ''


def test_first_frame_is_answered_within_two_seconds(
    start_program: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    small_model_file: Path,
) -> None:
    if cache_directory() is None:
        pytest.skip('no folder can be written, so the kernels are kept nowhere')
    warm_up(Estimator(load_model(small_model_file)))
    frame = next(synthetic_frames(SyntheticSettings(frames=1, seed=9)))
    model = f'model:={small_model_file}'
    node = start_program('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', '-p', model)
    assert node.prints('ready: listening'), node.output
    estimates.wait_for_node()
    camera.wait_for_node()
    sent = time.monotonic()
    camera.send(frame)
    assert estimates.wait_for(1), node.output
    assert time.monotonic() - sent < MOST_FOR_FIRST_FRAME, node.output
    (line,) = (each for each in node.output.splitlines() if 'kernels ready' in each)
    assert '[INFO]' in line
    assert line.endswith(f'({describe_cache()})')


def test_node_that_is_told_to_end_while_it_compiles_does_so_quietly(
    start_program: Callable[..., Program], small_model_file: Path
) -> None:
    node = start_program('-c', SLOW_START, '--ros-args', '-p', f'model:={small_model_file}')
    assert node.prints('compiling'), node.output
    assert node.exit_status(signal.SIGTERM) == 0, node.output
    assert 'Traceback' not in node.output
    assert 'ready: listening' not in node.output
