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

"""The tables of the documentation name the joints, the topics and the cameras."""

import re
from pathlib import Path

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.pose.stages import STAGE_NAMES
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.ros.health.diagnostic_status import Interval, status_of
from lsc_pose_ros.ros.health.measurements import Measurements
from lsc_pose_ros.ros.health.stream_warnings import Counters

ROOT = Path(__file__).resolve().parents[2]


def text_of(page: str) -> str:
    return (ROOT / 'docs' / f'{page}.md').read_text(encoding='utf-8')


def rows(page: str) -> list[list[str]]:
    """The cells of the rows of a page's tables."""
    lines = [line for line in text_of(page).splitlines() if line.startswith('|')]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


def test_joints_are_documented_with_their_numbers() -> None:
    named = re.findall(r'(\d+) `(\w+)`', text_of('joints'))
    assert {name: int(number) for number, name in named} == JOINT_NUMBERS


def test_topics_are_documented() -> None:
    topics = {cells[0].strip('`') for cells in rows('live')}
    assert topics >= {
        'depth/image', 'depth/camera_info', 'mask',
        '~/skeletons', '~/joint_markers', '/tf', '/diagnostics',
    }  # fmt: skip


def test_values_of_the_diagnostics_are_documented() -> None:
    stages = {name: [0.001] for name in ('decode', 'estimate', 'publish', *STAGE_NAMES)}
    measured = Measurements(estimates=1, failures=0, bodies=1, latencies=[0.01], stages=stages)
    interval = Interval(1.0, 0.0, Counters(), Counters(), measured)
    page = text_of('troubleshooting')
    documented = set(re.findall(r'`([^`]+)`', page))
    described = next(line for line in page.splitlines() if line.startswith('| `window p50 (ms)`'))
    for key in status_of(interval).values:
        stage, _, percentile = key.partition(' p')
        if percentile and stage in STAGE_NAMES:
            assert stage in described, key
        else:
            assert {key, key.replace('p95', 'p50')} & documented, key


def test_camera_presets_are_documented() -> None:
    cameras = set(re.findall(r'^\| \[`(\w+)`\]', text_of('cameras'), re.MULTILINE))
    presets = resource('config', 'cameras')
    assert cameras == {path.stem for path in presets.iterdir()}
