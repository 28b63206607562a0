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

"""The page on the method has the numbers of the pictures that it shows."""

import json
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[1] / 'docs'


@pytest.fixture(scope='module')
def text() -> str:
    return ' '.join((DOCS / 'how_it_works.md').read_text(encoding='utf-8').split())


@pytest.fixture(scope='module')
def numbers() -> dict[str, Any]:
    return json.loads((DOCS / 'images' / 'stages.json').read_text(encoding='utf-8'))


def test_pictures_are_of_the_frame_that_the_script_draws(numbers: dict[str, Any]) -> None:
    script = (DOCS / 'images.sh').read_text(encoding='utf-8')
    assert f'--stages {numbers["frame"].removeprefix("frame ")} ' in script


def test_body(text: str, numbers: dict[str, Any]) -> None:
    assert f'{numbers["near_m"]:.1f} to {numbers["far_m"]:.1f} m away' in text
    assert (
        f'All {numbers["edge_pixels"]} pixels of E are green. '
        f'The N = {numbers["points"]} points' in text
    )
    assert f': {numbers["unit_of_length_m"]:.2f} m here' in text


def test_modes(text: str, numbers: dict[str, Any]) -> None:
    modes = numbers['modes']
    two = [joint for joint, count in modes.items() if count == 2]
    assert max(modes.values()) == 2
    assert f'Most joints have one mode; {len(two)} of the {len(modes)} have two.' in text
    assert {'r_hand', 'l_hip'} <= set(two)


def test_steps_of_the_graph(text: str, numbers: dict[str, Any]) -> None:
    single, combined, ascended = (f'{100 * error:.1f} cm' for error in numbers['error_m'].values())
    alone, chosen, _ = numbers['joint_error_m'].values()
    assert f'the right hand is at the left one, {100 * alone["r_hand"]:.0f} cm off' in text
    assert f'the mean error of all joints is {single}' in text
    assert f'and also that of the left hip: {combined}' in text
    assert f'after ascent, {ascended}' in text
    assert {joint for joint in alone if alone[joint] != chosen[joint]} == {'r_hand', 'l_hip'}


def test_confidence(text: str, numbers: dict[str, Any]) -> None:
    confidence = numbers['confidence']
    ankles = min(confidence['l_ankle'], confidence['r_ankle'])
    hand = numbers['joint_error_m']['after ascent']['r_hand']
    assert (
        f'the confidence is {100 * ankles:.0f} % and more at the ankles, and '
        f'{100 * confidence["r_hand"]:.0f} % at the right hand, which is {100 * hand:.0f} cm off'
        in text
    )
    assert confidence['r_hand'] == min(confidence.values())
