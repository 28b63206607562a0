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
"""Debian's Chromium, driven by Playwright; without either, tests of pages are skipped."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

PATIENCE = 600_000
"""Milliseconds; a computer can be busy, and kernels not compiled."""

CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')
OPTIONS = (
    '--no-sandbox',
    '--disable-gpu',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--no-first-run',
)


def chromium() -> Iterator[Any]:
    """Yield a browser without a window."""
    playwright = pytest.importorskip('playwright.sync_api', reason='Playwright is not installed')
    if CHROMIUM is None:
        pytest.skip('Chromium is not installed')
    with playwright.sync_playwright() as engine:
        browser = engine.chromium.launch(executable_path=CHROMIUM, args=list(OPTIONS))
        yield browser
        browser.close()
