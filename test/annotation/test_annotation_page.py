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
import re
import shutil
import signal
import sys
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.visibility import HIDDEN, SEEN
from lsc_pose_ros.labels.sources.keypoints import SURFACE_TO_JOINT, surface_depth
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram

CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')
OPTIONS = (
    '--no-sandbox',
    '--disable-gpu',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--no-first-run',
)
FRAMES = 10
PATIENCE = 600_000  # milliseconds; a computer can be busy, and kernels not compiled
HAND = 'r_hand'
RIGHT = np.array([5, 0])
TYPED = 2.345  # metres


@pytest.fixture(scope='module')
def browser():
    """A browser without a window."""
    playwright = pytest.importorskip('playwright.sync_api', reason='Playwright is not installed')
    if CHROMIUM is None:
        pytest.skip('Chromium is not installed')
    with playwright.sync_playwright() as engine:
        chromium = engine.chromium.launch(executable_path=CHROMIUM, args=list(OPTIONS))
        yield chromium
        chromium.close()


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Ten frames of one person, without labels."""
    path = tmp_path / 'people.mcap'
    settings = SyntheticSettings(frames=FRAMES, seed=3, people=1)
    with RecordingWriter(path) as writer:
        for frame in synthetic_frames(settings):
            writer.write_frame(frame._replace(ground_truth=None))
    return path


@pytest.fixture
def page(browser):
    """A page; a failed script fails the test."""
    errors = []
    page = browser.new_page(viewport={'width': 1400, 'height': 900})
    page.set_default_timeout(PATIENCE)
    # Playwright cannot call methods of built-in types.
    page.on('pageerror', lambda error: errors.append(error))  # noqa: PLW0108
    yield page
    page.close()
    assert not errors


def open_page(page, program: AnnotationProgram) -> None:
    page.goto(program.address)
    page.wait_for_selector('circle.joint')


def circle(page, joint: str):
    return page.locator(f'circle[data-place$="/{joint}"]')


def drag(page, joint: str, right: float, down: float) -> None:
    """Drag a joint by so many pixels of the screen, and wait until it is kept."""
    box = circle(page, joint).bounding_box()
    x, y = box['x'] + box['width'] / 2, box['y'] + box['height'] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right, y + down, steps=4)
    with page.expect_response('**/keep/*'):
        page.mouse.up()


def press(page, key: str, wait_for: str = '**/keep/*') -> None:
    with page.expect_response(wait_for):
        page.keyboard.press(key)


def pixel_on_screen(page, joint: str) -> np.ndarray:
    """Return the pixel of the depth image where a joint is drawn."""
    found = circle(page, joint)
    return np.array([float(found.get_attribute(name)) for name in ('cx', 'cy')])


def edit_the_first_frame(page) -> dict[str, np.ndarray]:
    """Change joints by pointer, keys and fields; return the pixels where two of them are."""
    begin = pixel_on_screen(page, HAND)
    drag(page, HAND, -20, 15)
    dragged = pixel_on_screen(page, HAND)
    assert abs(dragged - begin).max() > 2
    press(page, 'Control+z')
    np.testing.assert_allclose(pixel_on_screen(page, HAND), begin, atol=0.01)
    press(page, 'Control+y')
    np.testing.assert_allclose(pixel_on_screen(page, HAND), dragged, atol=0.01)
    circle(page, 'head').focus()
    head = pixel_on_screen(page, 'head') + RIGHT
    for _ in range(RIGHT[0]):
        press(page, 'ArrowRight')
    np.testing.assert_allclose(pixel_on_screen(page, 'head'), head, atol=0.02)
    circle(page, 'l_knee').focus()
    press(page, 'h')
    circle(page, 'l_foot').focus()
    press(page, 'Delete')
    assert circle(page, 'l_foot').count() == 0
    circle(page, 'r_knee').focus()
    page.locator('#depth').fill(str(TYPED))
    press(page, 'Tab')
    return {HAND: dragged, 'head': head}


def wait_for_text(page, selector: str, text: str) -> None:
    page.locator(selector).filter(has_text=re.compile(f'^{text}$')).wait_for()


def accept(page, done: int) -> None:
    """Say that the frame is done, and wait until so many are."""
    with page.expect_response('**/keep/*'):
        page.locator('#accept').click()
    wait_for_text(page, '#count', f'{done} of {FRAMES}')
    if done < FRAMES:
        wait_for_text(page, '#frame', f'{done + 1} of {FRAMES}')


def check_first_frame(frame: Frame, pixels: dict[str, np.ndarray]) -> None:
    """Check what `edit_the_first_frame` has changed."""
    truth = frame.ground_truth
    positions = truth.positions[0]
    found = project(positions, frame.camera)
    for joint, pixel in pixels.items():
        np.testing.assert_allclose(found[JOINT_NUMBERS[joint]], pixel, atol=0.05)
    hand = JOINT_NUMBERS[HAND]
    surface = surface_depth(pixels[HAND], frame.depth)
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
    drag(page, HAND, 12, 0)
    kept = pixel_on_screen(page, HAND)
    # The computer fails.
    assert program.end(signal.SIGKILL)[0] == -signal.SIGKILL
    assert not output.exists()

    program = AnnotationProgram(recording, output)
    open_page(page, program)
    assert page.locator('#count').inner_text() == '2 of 10'
    assert page.locator('#frame').inner_text() == '3 of 10'
    np.testing.assert_allclose(pixel_on_screen(page, HAND), kept, atol=0.01)
    for number in range(3, FRAMES + 1):
        accept(page, number)
    with page.expect_response('**/finish'):
        page.locator('#finish').click()
    page.wait_for_selector('#message.good')
    status, out, err = program.end()
    assert status == 0, err
    assert '10 frames, 10 of them labelled, 10 bodies' in out
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
    page.locator('h1').click()
    press(page, 'a')
    circle(page, HAND).nth(count).wait_for()
    with page.expect_response('**/keep/*'):
        page.locator('#removeBody').click()
    circle(page, HAND).nth(count).wait_for(state='detached')
    first = pixel_on_screen(page, HAND)
    press(page, 'PageDown', '**/depth/1')
    wait_for_text(page, '#frame', '2 of 10')
    press(page, 'c')
    page.locator('#undo:enabled').wait_for()
    np.testing.assert_allclose(pixel_on_screen(page, HAND), first, atol=0.01)
    # Nothing is done, so there is nothing to write.
    page.locator('#finish').click()
    wait_for_text(page, '#message', 'no frame is done.*')
    status, _, err = program.end(signal.SIGINT)
    assert status == 130, err
    lines = Path(f'{tmp_path}/labelled.mcap.journal').read_text().splitlines()
    assert json.loads(lines[0])['count'] == FRAMES
    assert len(lines) > 3


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('width', [390, 1400])
def test_the_page_fits_the_screen(browser, recording, tmp_path, width, scheme) -> None:
    program = AnnotationProgram(recording, tmp_path / 'labelled.mcap')
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
