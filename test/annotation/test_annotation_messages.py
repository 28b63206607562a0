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
"""What the page of `lsc_pose annotate` says if something is not as one may expect."""

import signal
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from page_steps import (
    centre,
    circle,
    drag,
    drag_joint,
    open_page,
    pixel_of,
    press,
    text_of,
    write,
)

HAND = 'r_hand'
BELOW = np.array([0, 30])  # pixels of the screen
ENDED = 'The command no longer runs; start it again and open the new address.'
STRANGE = 'This address is that of an earlier command; open the one that it prints now.'


@pytest.fixture
def program(labelled, tmp_path):
    """The command on ten labelled frames."""
    program = AnnotationProgram(labelled, tmp_path / 'labelled.mcap')
    yield program
    program.end(signal.SIGINT)


def depth_of(page) -> str:
    return page.locator('#depth').input_value()


def test_a_depth_that_no_joint_has_is_refused(page, program) -> None:
    open_page(page, program)
    circle(page, 'l_knee').focus()
    before = depth_of(page)
    for wrong in ('999', '0.05', '-2', ''):
        write(page, '#depth', wrong)
        assert text_of(page, '#message') == 'The depth must be 0.1 to 100 m.'
        assert depth_of(page) == before
    write(page, '#depth', '3.5')
    assert text_of(page, '#message') == ''
    assert depth_of(page) == '3.500'


def test_a_joint_on_the_background_keeps_its_depth_and_says_so(page, program, person) -> None:
    open_page(page, program)
    circle(page, HAND).focus()
    before, begin = depth_of(page), centre(page, HAND)
    image = page.locator('#image').bounding_box()
    corner = np.array([image['x'] + 20, image['y'] + 20])
    drag(page, begin, corner - begin)
    metres = f'{float(before):.2f} m'
    assert text_of(page, '#message') == (
        f'The right hand is not on a body there: its depth stays {metres}. '
        'Type another if it is wrong.'
    )
    assert depth_of(page) == before
    # On the body, it is as deep as the body.
    torso = centre(page, 'torso')
    drag(page, centre(page, HAND), torso - centre(page, HAND) + BELOW)
    assert text_of(page, '#message') == ''
    column, row = np.rint(pixel_of(page, HAND)).astype(int)
    assert float(depth_of(page)) == pytest.approx(person[0].depth[row, column] + 0.02, abs=0.05)
    assert depth_of(page) != before


def test_a_command_that_has_stopped_is_named(page, labelled, tmp_path) -> None:
    output = tmp_path / 'labelled.mcap'
    program = AnnotationProgram(labelled, output)
    open_page(page, program)
    caption, hand = text_of(page, '#caption'), pixel_of(page, HAND)
    program.end(signal.SIGINT)
    press(page, 'PageDown')
    assert text_of(page, '#message') == ENDED
    assert text_of(page, '#caption') == caption
    # What was not kept is not shown.
    drag_joint(page, HAND, 40, 40)
    assert text_of(page, '#message') == ENDED
    np.testing.assert_allclose(pixel_of(page, HAND), hand)
    again = AnnotationProgram(labelled, output, '--port', str(program.port))
    try:
        press(page, 'PageDown')
        assert text_of(page, '#message') == STRANGE
    finally:
        again.end(signal.SIGINT)
