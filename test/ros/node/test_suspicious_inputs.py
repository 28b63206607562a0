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

"""What the live node says about masks and scenes that are probably not as they should be."""

from collections.abc import Callable

import numpy as np
import pytest
from live_ros import Camera, Program, PublishedEstimates, generate

from lsc_pose_ros.data_types.frame import NO_BODY, Frame


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    return generate(tmp_path_factory.mktemp('frames'), frames=4)


def send_all(
    camera: Camera, estimates: PublishedEstimates, node: Program, frames: list[Frame]
) -> None:
    """Send frames one by one, each after the answer to the one before."""
    for count, frame in enumerate(frames, 1):
        camera.send(frame)
        assert estimates.wait_for(count), node.output


def test_background_that_is_taken_for_a_body_is_asked_about_once(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
) -> None:
    node = start_node()
    camera.wait_for_node()
    estimates.wait_for_node()
    as_azure = [
        frame._replace(labels=np.where(frame.labels == NO_BODY, 255, frame.labels))
        for frame in frames
    ]
    send_all(camera, estimates, node, as_azure)
    assert node.prints('/mask: the value 255 covers ')
    assert 'because mask_background is 0; is mask_background right?' in node.output
    assert node.output.count('the value 255 covers') == 1


def test_scene_that_was_not_empty_is_a_warning(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
) -> None:
    """A person walks through the scene while it is learnt."""
    node = start_node(segmentation='background', background_seconds=0.5)
    camera.wait_for_node(mask=False)
    estimates.wait_for_node()
    frame = frames[0]
    wall = np.full_like(frame.depth, 4.5)
    body = frame.labels != NO_BODY
    walking = []
    for number in range(8):
        moved = np.roll(body, 30 * number, axis=1)
        depth = np.where(moved, np.float32(2.5), wall)
        walking.append(frame._replace(stamp=frame.stamp + number * 10**8, depth=depth))
    send_all(camera, estimates, node, walking)
    assert node.prints('the scene was not empty while it was learnt')
