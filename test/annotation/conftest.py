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
"""A recording of one person, and a page in a browser."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import PATIENCE

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

WALL = 5.0  # metres


@pytest.fixture(scope='session')
def person() -> list[Frame]:
    """Ten labelled frames of one person before a wall."""
    return [
        frame._replace(depth=np.where(frame.labels == NO_BODY, np.float32(WALL), frame.depth))
        for frame in synthetic_frames(SyntheticSettings(frames=10, seed=3, people=1))
    ]


@pytest.fixture(scope='session')
def recording(person: list[Frame], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The frames of `person` without labels; not to be changed."""
    path = tmp_path_factory.mktemp('person') / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in person:
            writer.write_frame(frame._replace(ground_truth=None))
    return path


@pytest.fixture(scope='session')
def labelled(person: list[Frame], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The frames of `person` with labels, so that no model is run; not to be changed."""
    path = tmp_path_factory.mktemp('labelled') / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in person:
            writer.write_frame(frame)
    return path


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page; a failed script fails the test."""
    errors: list[object] = []
    page = browser.new_page(viewport={'width': 1400, 'height': 900})
    page.set_default_timeout(PATIENCE)
    # Playwright cannot call methods of built-in types.
    page.on('pageerror', lambda error: errors.append(error))  # noqa: PLW0108
    yield page
    page.close()
    assert not errors
