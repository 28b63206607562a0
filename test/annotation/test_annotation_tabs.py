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
"""Two pages of one annotation, and a journal that cannot be written."""

import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from browser import PATIENCE

from lsc_pose_ros.bags import open_recording

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from page_steps import click, drag_joint, open_page, pixel_of, press, settle, text_of

HAND = 'r_hand'
SEEN_AGAIN = "document.dispatchEvent(new Event('visibilitychange'))"


@pytest.fixture
def program(labelled, tmp_path):
    """The command on ten labelled frames."""
    program = AnnotationProgram(labelled, tmp_path / 'labelled.mcap')
    yield program
    program.end(signal.SIGINT)


@pytest.fixture
def other(browser):
    """A second page."""
    other = browser.new_page()
    other.set_default_timeout(PATIENCE)
    yield other
    other.close()


def test_a_page_does_not_replace_what_another_one_has_changed(page, other, program) -> None:
    open_page(page, program)
    open_page(other, program)
    drag_joint(page, HAND, -30, 20)
    kept = pixel_of(page, HAND)
    drag_joint(other, 'head', 25, 0)
    assert text_of(other, '#message') == (
        'Frame 0 was changed on another page meanwhile; the change is not kept.'
    )
    # It shows what was kept, and can be changed now.
    np.testing.assert_allclose(pixel_of(other, HAND), kept, atol=0.01)
    head = pixel_of(other, 'head')
    drag_joint(other, 'head', 25, 0)
    assert text_of(other, '#message') == ''
    assert abs(pixel_of(other, 'head') - head).max() > 1
    # Neither does "done", nor undo.
    press(page, 'Control+z')
    assert text_of(page, '#message').startswith('Frame 0 was changed on another page')
    np.testing.assert_allclose(pixel_of(page, HAND), kept, atol=0.01)
    assert page.locator('#undo').is_disabled()
    click(other, '#accept')
    press(page, 'Delete')
    click(page, '#accept')
    assert text_of(page, '#frame') == '1 of the recording (2 of 10)'


def test_a_page_that_is_looked_at_again_shows_what_others_have_changed(
    page, other, program
) -> None:
    open_page(page, program)
    open_page(other, program)
    drag_joint(page, HAND, -30, 20)
    kept = pixel_of(page, HAND)
    click(page, '#accept')
    other.evaluate(SEEN_AGAIN)
    settle(other)
    assert text_of(other, '#message') == (
        'Frame 0 was changed on another page; it is shown as it is there.'
    )
    np.testing.assert_allclose(pixel_of(other, HAND), kept, atol=0.01)
    assert text_of(other, '#count') == '1 of 10'
    assert 'is done' in text_of(other, '#caption')
    other.evaluate(SEEN_AGAIN)
    settle(other)
    assert text_of(other, '#message') == ''


def test_a_change_that_cannot_be_kept_is_told_and_not_shown(page, program, tmp_path) -> None:
    open_page(page, program)
    click(page, '#accept')
    hand = pixel_of(page, HAND)
    Path(f'{tmp_path}/labelled.mcap.journal').unlink()
    drag_joint(page, HAND, -30, 20)
    message = text_of(page, '#message')
    assert 'labelled.mcap.journal was deleted' in message
    assert 'the change is not kept' in message
    np.testing.assert_allclose(pixel_of(page, HAND), hand)
    click(page, '#finish')
    assert 'This page can be closed' in text_of(page, '#message.good')
    # What was written stays said, and nothing can be changed any more.
    page.evaluate(SEEN_AGAIN)
    press(page, 'PageDown', 'a')
    assert page.evaluate("document.getElementById('panel').inert")
    np.testing.assert_allclose(pixel_of(page, HAND), hand)
    assert 'This page can be closed' in text_of(page, '#message')
    labels = [frame.ground_truth for frame in open_recording(tmp_path / 'labelled.mcap')]
    assert [len(each.bodies) for each in labels] == [1, *[0] * 9]
