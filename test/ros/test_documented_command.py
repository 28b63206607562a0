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

"""The commands that start the node without a launch file, as the pages have them, played to."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from live_ros import Camera, Program, PublishedEstimates, generate
from rclpy.node import Node

ROOT = Path(__file__).resolve().parents[2]

PAGES = ('README.md', 'docs/live.md')


def command_in(page: str) -> list[str]:
    """Return the words of the command in a page that starts the node with its topics."""
    text = (ROOT / page).read_text(encoding='utf-8').replace('\\\n', ' ')
    lines = re.findall(r'^    (pose_node .*depth/image:=.*)$', text, re.MULTILINE)
    assert len(lines) == 1, page
    return shlex.split(lines[0])


@pytest.mark.parametrize('page', PAGES)
def test_command_of_the_page_gives_joints(
    page: str,
    start_program: Callable[..., Program],
    probe: Node,
    estimates: PublishedEstimates,
    small_model_file: Path,
    tmp_path: Path,
) -> None:
    words = command_in(page)
    topics = dict(re.findall(r'(\S+):=(/\S+)', ' '.join(words)))
    node = start_program(
        '-m', 'lsc_pose_ros.ros.node.main', *words[1:], '-p', f'model:={small_model_file}'
    )
    camera = Camera(
        probe, topics['depth/image'], topics['depth/camera_info'], topics.get('mask', 'unused')
    )
    camera.wait_for_node(mask='mask' in topics)
    estimates.wait_for_node()
    for count, frame in enumerate(generate(tmp_path, frames=6, background=True), 1):
        camera.send(frame)
        assert estimates.wait_for(count), node.output
    # Without masks, the node may miss a person in a single frame.
    seen = [np.isfinite(found.positions).any() for found in estimates.skeletons.values()]
    assert sum(seen) >= len(seen) // 2
