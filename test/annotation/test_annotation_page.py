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
"""The page of `lsc_pose annotate` in a real browser, from the first frame to the recording."""

import json
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from browser import PATIENCE

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.visibility import HIDDEN, SEEN
from lsc_pose_ros.labels.sources.keypoints import SURFACE_TO_JOINT, surface_depth

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from page_steps import circle, click, drag_joint, open_page, pixel_of, press, text_of, write

FRAMES = 10
HAND = 'r_hand'
RIGHT = np.array([5, 0])
TYPED = 2.345  # metres


def edit_the_first_frame(page) -> dict[str, np.ndarray]:
    """Change joints by pointer, keys and fields; return the pixels where two of them are."""
    begin = pixel_of(page, HAND)
    drag_joint(page, HAND, -20, 15)
    dragged = pixel_of(page, HAND)
    assert abs(dragged - begin).max() > 2
    press(page, 'Control+z')
    np.testing.assert_allclose(pixel_of(page, HAND), begin, atol=0.01)
    press(page, 'Control+y')
    np.testing.assert_allclose(pixel_of(page, HAND), dragged, atol=0.01)
    circle(page, 'head').focus()
    head = pixel_of(page, 'head') + RIGHT
    press(page, *['ArrowRight'] * int(RIGHT[0]))
    np.testing.assert_allclose(pixel_of(page, 'head'), head, atol=0.02)
    circle(page, 'l_knee').focus()
    press(page, 'h')
    circle(page, 'l_foot').focus()
    press(page, 'Delete')
    assert circle(page, 'l_foot').count() == 0
    circle(page, 'r_knee').focus()
    write(page, '#depth', str(TYPED))
    return {HAND: dragged, 'head': head}


def accept(page, done: int) -> None:
    """Say that the frame is done, and check that so many are."""
    click(page, '#accept')
    assert text_of(page, '#count') == f'{done} of {FRAMES}'
    number = min(done, FRAMES - 1)
    assert text_of(page, '#frame') == f'{number} of the recording ({number + 1} of {FRAMES})'


def check_first_frame(frame: Frame, pixels: dict[str, np.ndarray]) -> None:
    """Check what `edit_the_first_frame` has changed."""
    truth = frame.ground_truth
    positions = truth.positions[0]
    found = project(positions, frame.camera)
    for joint, pixel in pixels.items():
        np.testing.assert_allclose(found[JOINT_NUMBERS[joint]], pixel, atol=0.05)
    hand = JOINT_NUMBERS[HAND]
    of_body = np.where(frame.labels == NO_BODY, np.float32(0), frame.depth)
    surface = surface_depth(pixels[HAND], of_body)
    if np.isfinite(surface):
        assert positions[hand, 2] == pytest.approx(surface + SURFACE_TO_JOINT[hand], abs=1e-3)
    assert positions[JOINT_NUMBERS['r_knee'], 2] == pytest.approx(TYPED, abs=1e-3)
    assert np.isnan(positions[JOINT_NUMBERS['l_foot']]).all()
    assert truth.visibility[0, JOINT_NUMBERS['l_knee']] == HIDDEN
    assert truth.visibility[0, hand] == SEEN


def test_a_recording_is_annotated_with_an_interruption(page, recording, tmp_path) -> None:
    output = tmp_path / 'labelled.mcap'
    program = AnnotationProgram(recording, output)
    open_page(page, program)
    assert page.locator('#count').inner_text() == '0 of 10'
    pixels = edit_the_first_frame(page)
    accept(page, 1)
    accept(page, 2)
    drag_joint(page, HAND, 12, 0)
    kept = pixel_of(page, HAND)
    # The computer fails.
    assert program.end(signal.SIGKILL)[0] == -signal.SIGKILL
    assert not output.exists()

    program = AnnotationProgram(recording, output)
    open_page(page, program)
    assert page.locator('#count').inner_text() == '2 of 10'
    assert text_of(page, '#frame') == '2 of the recording (3 of 10)'
    np.testing.assert_allclose(pixel_of(page, HAND), kept, atol=0.01)
    for number in range(3, FRAMES + 1):
        accept(page, number)
    click(page, '#finish')
    assert 'This page can be closed' in text_of(page, '#message.good')
    status, out, err = program.end()
    assert status == 0, err
    assert out.splitlines()[-1] == f'{output}: 10 frames, 10 of them labelled, 10 bodies'
    assert not Path(f'{output}.journal').exists()

    frames = list(open_recording(output))
    assert len(frames) == FRAMES
    check_first_frame(frames[0], pixels)
    third = project(frames[2].ground_truth.positions[0], frames[2].camera)
    np.testing.assert_allclose(third[JOINT_NUMBERS[HAND]], kept, atol=0.05)


def test_a_body_can_be_copied_added_and_removed(page, recording, tmp_path) -> None:
    program = AnnotationProgram(recording, tmp_path / 'labelled.mcap')
    open_page(page, program)
    count = circle(page, HAND).count()
    circle(page, HAND).first.focus()
    press(page, 'a')
    assert circle(page, HAND).count() == count + 1
    assert page.locator('#joint').input_value() == f'{count + 1}/head'
    click(page, '#removeBody')
    assert circle(page, HAND).count() == count
    first = pixel_of(page, HAND)
    press(page, 'PageDown')
    assert text_of(page, '#frame') == '1 of the recording (2 of 10)'
    press(page, 'c')
    assert page.locator('#undo').is_enabled()
    np.testing.assert_allclose(pixel_of(page, HAND), first, atol=0.01)
    # Nothing is done, so there is nothing to write.
    click(page, '#finish')
    assert text_of(page, '#message').startswith('No frame is done')
    status, _, err = program.end(signal.SIGINT)
    assert status == 130, err
    lines = Path(f'{tmp_path}/labelled.mcap.journal').read_text().splitlines()
    assert json.loads(lines[0])['recording'] == recording.name
    assert len(lines) > 3


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('width', [390, 1400])
def test_the_page_fits_the_screen(browser, labelled, tmp_path, width, scheme) -> None:
    program = AnnotationProgram(labelled, tmp_path / 'labelled.mcap')
    page = browser.new_page(viewport={'width': width, 'height': 844}, color_scheme=scheme)
    try:
        page.set_default_timeout(PATIENCE)
        open_page(page, program)
        assert page.evaluate('document.documentElement.scrollWidth') <= width
        box = page.locator('#image').bounding_box()
        assert box['width'] > 0.9 * min(width, 500)
        for name in ('button', 'select', 'input', 'circle'):
            for each in page.locator(name).all():
                assert each.evaluate(
                    'e => Boolean(e.ariaLabel || e.textContent || (e.labels && e.labels.length))'
                )
    finally:
        page.close()
        program.end(signal.SIGINT)
