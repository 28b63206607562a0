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
"""The page of `lsc_pose annotate` on a touch screen."""

import signal
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from browser import PATIENCE

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from page_steps import centre, open_page, pixel_of, settle, text_of

HAND, FOOT, HEAD = 'r_hand', 'l_foot', 'head'
ROUNDING = 1.5  # pixels of the screen
VIEW_BOX = "document.getElementById('image').getAttribute('viewBox')"


@pytest.fixture
def program(labelled, tmp_path):
    """The command on ten labelled frames."""
    program = AnnotationProgram(labelled, tmp_path / 'labelled.mcap')
    yield program
    program.end(signal.SIGINT)


@pytest.fixture
def phone(browser):
    """A page on a phone; a failed script fails the test."""
    errors = []
    context = browser.new_context(has_touch=True, viewport={'width': 390, 'height': 844})
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.on('pageerror', lambda error: errors.append(error))  # noqa: PLW0108
    yield page
    context.close()
    assert not errors


class Fingers:
    """Fingers on a page, by their numbers."""

    def __init__(self, page) -> None:
        self._page = page
        self._session = page.context.new_cdp_session(page)
        self._points: dict[int, np.ndarray] = {}

    def put(self, number: int, point: np.ndarray) -> None:
        self._points[number] = point
        self._send('touchStart')

    def move(self, points: Mapping[int, np.ndarray], steps: int = 6) -> None:
        """Move fingers to points, straight on."""
        begin = dict(self._points)
        for step in range(1, steps + 1):
            for number, end in points.items():
                share = step / steps
                self._points[number] = (1 - share) * begin[number] + share * end
            self._send('touchMove')

    def lift(self) -> None:
        """Lift all fingers, and wait."""
        self._points.clear()
        self._send('touchEnd')
        settle(self._page)

    def _send(self, kind: str) -> None:
        points = [{'x': x, 'y': y, 'id': number} for number, (x, y) in self._points.items()]
        self._session.send('Input.dispatchTouchEvent', {'type': kind, 'touchPoints': points})


def test_a_finger_drags_a_joint_that_is_near(phone, program) -> None:
    open_page(phone, program)
    fingers = Fingers(phone)
    begin, pixel = centre(phone, FOOT), pixel_of(phone, FOOT)
    # Chromium itself finds what is up to 10 pixels beside a circle of 6.
    away = np.array([0.0, 21.0])
    way = np.array([-25.0, 20.0])
    fingers.put(1, begin + away)
    fingers.move({1: begin + away + way})
    fingers.lift()
    assert phone.locator('#joint').input_value() == f'1/{FOOT}'
    np.testing.assert_allclose(centre(phone, FOOT), begin + way, atol=ROUNDING)
    assert abs(pixel_of(phone, FOOT) - pixel).max() > 1
    assert phone.locator('#undo').is_enabled()


def test_a_tap_selects_a_joint_and_does_not_move_it(phone, program) -> None:
    open_page(phone, program)
    fingers = Fingers(phone)
    pixel = pixel_of(phone, FOOT)
    fingers.put(1, centre(phone, FOOT))
    fingers.move({1: centre(phone, FOOT) + np.array([3.0, 2.0])})
    fingers.lift()
    assert phone.locator('#joint').input_value() == f'1/{FOOT}'
    np.testing.assert_array_equal(pixel_of(phone, FOOT), pixel)
    assert phone.locator('#undo').is_disabled()


def test_two_fingers_zoom_and_move_the_image(phone, program) -> None:
    open_page(phone, program)
    fingers = Fingers(phone)
    head, hand = centre(phone, HEAD), centre(phone, HAND)
    image = phone.locator('#image').bounding_box()
    corner = np.array([image['x'] + 40.0, image['y'] + 40.0])
    spread, way = np.array([30.0, 0.0]), np.array([20.0, 30.0])
    fingers.put(1, corner - spread)
    fingers.put(2, corner + spread)
    # Twice as far from one another, and both further to the right and down.
    fingers.move({1: corner - 2 * spread + way, 2: corner + 2 * spread + way}, steps=10)
    fingers.lift()
    for joint, before in ((HEAD, head), (HAND, hand)):
        expected = corner + way + 2 * (before - corner)
        np.testing.assert_allclose(centre(phone, joint), expected, atol=2 * ROUNDING)
    assert phone.locator('#undo').is_disabled()


def test_a_second_finger_ends_the_drag_of_a_joint(phone, program) -> None:
    open_page(phone, program)
    fingers = Fingers(phone)
    pixel, begin = pixel_of(phone, FOOT), centre(phone, FOOT)
    fingers.put(1, begin)
    fingers.move({1: begin - np.array([30.0, 0.0])})
    fingers.put(2, begin - np.array([0.0, 190.0]))
    fingers.move({2: begin - np.array([0.0, 150.0])})
    fingers.lift()
    np.testing.assert_array_equal(pixel_of(phone, FOOT), pixel)
    assert phone.locator('#undo').is_disabled()
    assert text_of(phone, '#message') == ''
    # The next finger drags again.
    begin = centre(phone, HEAD)
    fingers.put(1, begin)
    fingers.move({1: begin + np.array([20.0, 10.0])})
    fingers.lift()
    np.testing.assert_allclose(centre(phone, HEAD), begin + np.array([20.0, 10.0]), atol=ROUNDING)


def test_a_button_shows_the_people_again(phone, program) -> None:
    open_page(phone, program)
    before = phone.evaluate(VIEW_BOX)
    fingers = Fingers(phone)
    image = phone.locator('#image').bounding_box()
    corner = np.array([image['x'] + 100.0, image['y'] + 100.0])
    fingers.put(1, corner - np.array([80.0, 0.0]))
    fingers.put(2, corner + np.array([80.0, 0.0]))
    fingers.move({1: corner - np.array([2.0, 0.0]), 2: corner + np.array([2.0, 0.0])})
    fingers.lift()
    width, height = map(float, phone.evaluate(VIEW_BOX).split()[2:])
    assert width > 1.2 * float(before.split()[2])
    assert height > 1.2 * float(before.split()[3])
    phone.locator('#fit').tap()
    settle(phone)
    assert phone.evaluate(VIEW_BOX) == before


def test_a_message_is_seen_from_the_button_below_the_image(phone, program) -> None:
    open_page(phone, program)
    phone.locator('summary').tap()
    phone.locator('#finish').tap()
    settle(phone)
    assert text_of(phone, '#message').startswith('No frame is done yet')
    phone.evaluate('window.scrollTo(0, document.documentElement.scrollHeight)')
    box = phone.locator('#message').bounding_box()
    assert box['y'] >= 0
    assert box['y'] + box['height'] <= phone.viewport_size['height'] + ROUNDING
    assert phone.evaluate('document.documentElement.scrollWidth') <= 390
