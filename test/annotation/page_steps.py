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
"""What the tests do on the page of `lsc_pose annotate`."""

import re

import numpy as np
from annotation_program import AnnotationProgram


def open_page(page, program: AnnotationProgram) -> None:
    """Open the page of a program, and wait for its first frame."""
    page.goto(program.address)
    page.wait_for_selector('circle.joint')
    settle(page)


def settle(page) -> None:
    """Wait until the page has done all that it was asked to do."""
    page.wait_for_selector('#image[aria-busy=false]')


def circle(page, joint: str):
    """Return the circles of a joint, one for each body."""
    return page.locator(f'circle[data-place$="/{joint}"]')


def centre(page, joint: str) -> np.ndarray:
    """Return where on the screen a joint is drawn, pixels."""
    box = circle(page, joint).bounding_box()
    return np.array([box['x'] + box['width'] / 2, box['y'] + box['height'] / 2])


def pixel_of(page, joint: str) -> np.ndarray:
    """Return the pixel of the depth image where a joint is drawn."""
    found = circle(page, joint)
    return np.array([float(found.get_attribute(name)) for name in ('cx', 'cy')])


def drag(page, begin: np.ndarray, by: np.ndarray) -> None:
    """Drag what is at a point of the screen by so many pixels, and wait."""
    page.mouse.move(*begin.tolist())
    page.mouse.down()
    page.mouse.move(*(begin + by).tolist(), steps=4)
    page.mouse.up()
    settle(page)


def drag_joint(page, joint: str, right: float, down: float) -> None:
    """Drag a joint by so many pixels of the screen, and wait."""
    drag(page, centre(page, joint), np.array([right, down]))


def press(page, *keys: str) -> None:
    """Press keys, and wait after each."""
    for key in keys:
        page.keyboard.press(key)
        settle(page)


def click(page, selector: str) -> None:
    """Click, and wait."""
    page.locator(selector).click()
    settle(page)


def write(page, selector: str, text: str) -> None:
    """Type into a field, leave it with Enter, and wait."""
    page.locator(selector).fill(text)
    press(page, 'Enter')


def text_of(page, selector: str) -> str:
    """Return the text of an element without line ends."""
    return re.sub(r'\s+', ' ', page.locator(selector).inner_text())
