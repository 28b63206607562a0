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
"""The page of `lsc_pose annotate`: numbers of frames, colours, and parts of the image."""

import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from browser import PATIENCE

from lsc_pose_ros.viz.drawing.colours import PALETTE

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from page_steps import (
    centre,
    circle,
    click,
    drag,
    open_page,
    pixel_of,
    press,
    settle,
    text_of,
    write,
)

ELBOW, WRIST, HAND = 'r_elbow', 'r_wrist', 'r_hand'
SIDES = {'left': 'l_hand', 'right': 'r_hand', 'middle': 'head'}
NAMES = {'left': 'left', 'right': 'right', 'middle': 'ink'}
ROUNDING = 1.5  # pixels of the screen

VIEW_BOX = "document.getElementById('image').getAttribute('viewBox')"
COLOUR = """selector => {
  const [element, pseudo] = selector.split('::');
  const style = getComputedStyle(document.querySelector(element), pseudo && `::${pseudo}`);
  return pseudo ? style.backgroundColor : style.fill;
}"""


@pytest.fixture(scope='module')
def program(labelled, tmp_path_factory):
    """The command on each third of ten labelled frames; the tests change nothing."""
    output = tmp_path_factory.mktemp('view') / 'labelled.mcap'
    program = AnnotationProgram(labelled, output, '--every', '3')
    yield program
    program.end(signal.SIGINT)


def view_box(page) -> np.ndarray:
    """Return left, top, width and height of what is shown, pixels of the depth image."""
    return np.array([float(word) for word in page.evaluate(VIEW_BOX).split()])


def rgb(colour: str) -> str:
    red, green, blue = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return f'rgb({red}, {green}, {blue})'


def test_frames_have_their_numbers_in_the_recording(page, program) -> None:
    open_page(page, program)
    assert text_of(page, '#frame') == '0 of the recording (1 of 4)'
    press(page, 'PageDown')
    assert text_of(page, '#frame') == '3 of the recording (2 of 4)'
    assert text_of(page, '#caption') == 'Frame 3 of the recording (2 of 4) is open; 1 body.'
    press(page, 'g')
    page.keyboard.type('9')
    press(page, 'Enter')
    assert text_of(page, '#frame') == '9 of the recording (4 of 4)'
    assert text_of(page, '#message') == ''
    write(page, '#goto', '7')
    assert text_of(page, '#frame') == '6 of the recording (3 of 4)'
    assert text_of(page, '#message') == ('Frame 7 is not among those to label; 6 is the nearest.')
    for wrong in ('10', '-1', '1.5', ''):
        write(page, '#goto', wrong)
        assert text_of(page, '#message') == 'The recording has the frames 0 to 9.'
        assert page.locator('#goto').input_value() == '6'
    assert text_of(page, '#frame') == '6 of the recording (3 of 4)'


@pytest.mark.parametrize('scheme', ['light', 'dark'])
def test_colours_are_those_of_all_pages_and_are_explained(browser, program, scheme) -> None:
    page = browser.new_page(color_scheme=scheme)
    try:
        page.set_default_timeout(PATIENCE)
        open_page(page, program)
        for side, joint in SIDES.items():
            expected = rgb(PALETTE[NAMES[side]].dark)  # the picture is black in both schemes
            assert page.evaluate(COLOUR, f'circle[data-place$="/{joint}"]') == expected, side
            assert page.evaluate(COLOUR, f'#legend .{side}::before') == expected, side
        assert text_of(page, '#legend .left') == "the person's left"
        assert text_of(page, '#legend .right') == "the person's right"
        background = page.evaluate('getComputedStyle(document.body).backgroundColor')
        assert background == rgb(getattr(PALETTE['page'], scheme))
    finally:
        page.close()


def test_the_spine_goes_from_the_head_to_the_pelvis(page, program) -> None:
    open_page(page, program)
    ends = page.evaluate("""[...document.querySelectorAll('.limb.middle')].map(line =>
        ['x1', 'y1', 'x2', 'y2'].map(name => Number(line.getAttribute(name))))""")
    drawn = {tuple(np.round(line, 2).tolist()) for line in ends}
    spine = ('neck', 'head'), ('neck', 'torso'), ('torso', 'pelvis')
    assert drawn == {
        tuple(np.round(np.concatenate([pixel_of(page, end) for end in limb]), 2).tolist())
        for limb in spine
    }


def test_people_fill_the_picture_at_first(page, program, person) -> None:
    open_page(page, program)
    left, top, width, height = view_box(page)
    rows, columns = np.nonzero(person[0].labels >= 0)
    assert left <= columns.min()
    assert columns.max() <= left + width
    assert top <= rows.min()
    assert rows.max() <= top + height
    assert np.ptp(rows) > 0.7 * height or np.ptp(columns) > 0.7 * width
    press(page, 'w')
    left, top, width, height = view_box(page)
    rows, columns = person[0].depth.shape
    assert min(width - columns, height - rows) == pytest.approx(0, abs=1e-6)
    assert left <= 0
    assert top <= 0
    click(page, '#fit')
    assert view_box(page)[3] < height


def test_keys_zoom_at_the_selected_joint(page, program) -> None:
    open_page(page, program)
    circle(page, HAND).focus()
    before = centre(page, HAND), centre(page, ELBOW)
    size = circle(page, HAND).bounding_box()['width']
    press(page, 'i')
    np.testing.assert_allclose(centre(page, HAND), before[0], atol=ROUNDING)
    np.testing.assert_allclose(
        centre(page, ELBOW) - before[0], 1.5 * (before[1] - before[0]), atol=ROUNDING
    )
    # The circles stay small, so that joints side by side come apart.
    assert circle(page, HAND).bounding_box()['width'] == pytest.approx(size, abs=0.5)
    zoomed = view_box(page)
    press(page, 'PageDown')
    np.testing.assert_allclose(view_box(page)[2:], zoomed[2:])
    press(page, 'PageUp', 'o')
    np.testing.assert_allclose(centre(page, ELBOW), before[1], atol=ROUNDING)


def test_the_joint_that_the_keyboard_selects_is_in_the_picture(page, program) -> None:
    open_page(page, program)
    circle(page, 'head').focus()
    press(page, *['i'] * 5)
    image = page.locator('#image').bounding_box()

    def is_in_picture(joint: str) -> bool:
        x, y = centre(page, joint)
        right, bottom = image['x'] + image['width'], image['y'] + image['height']
        return image['x'] < x < right and image['y'] < y < bottom

    assert not is_in_picture('l_foot')
    page.locator('#joint').select_option('1/l_foot')
    assert is_in_picture('l_foot')
    assert not is_in_picture('head')
    circle(page, 'head').focus()
    assert is_in_picture('head')


def test_the_wheel_zooms_at_the_pointer_and_the_background_is_dragged(page, program) -> None:
    open_page(page, program)
    wrist, elbow = centre(page, WRIST), centre(page, ELBOW)
    page.mouse.move(*wrist.tolist())
    before = page.evaluate(VIEW_BOX)
    page.mouse.wheel(0, -200)
    page.wait_for_function(f'before => {VIEW_BOX} !== before', arg=before)
    settle(page)
    np.testing.assert_allclose(centre(page, WRIST), wrist, atol=ROUNDING)
    factor = np.exp(0.002 * 200)
    np.testing.assert_allclose(
        centre(page, ELBOW) - wrist, factor * (elbow - wrist), atol=ROUNDING
    )
    image = page.locator('#image').bounding_box()
    corner = np.array([image['x'] + 30, image['y'] + 30])
    way = np.array([40, 25])
    drag(page, corner, way)
    np.testing.assert_allclose(centre(page, WRIST), wrist + way, atol=ROUNDING)
