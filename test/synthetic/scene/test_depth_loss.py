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

"""Tests the loss of depth on dark parts of people and in patches of the image."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.depth_loss import (
    DarkParts,
    DepthLoss,
    Patch,
    apply_loss,
    sample_loss,
)
from lsc_pose_ros.synthetic.scene.pixel_codes import pixel_codes

CODES = pixel_codes(1, np.array([3, 9], np.int32))


def halves() -> DepthImage:
    """Return an image whose left half shows part 3 of body 1, and the right half part 9."""
    labels = np.repeat(CODES, 80) * np.ones((120, 1), np.int32)
    return DepthImage(np.full((120, 160), 2.0, np.float32), labels)


@pytest.mark.parametrize('fraction', [0.2, 0.5, 0.9])
def test_dark_parts_lose_a_fraction_of_their_pixels(fraction: float) -> None:
    lost = []
    for seed in range(10):
        image = halves()
        dark = DepthLoss((DarkParts(1, (9,), fraction),))
        apply_loss(image, dark, np.random.default_rng(seed))
        assert (image.depth[:, :80] == 2.0).all()
        np.testing.assert_array_equal(image.depth == 0.0, image.labels == NO_BODY)
        lost.append((image.depth[:, 80:] == 0).mean())
    assert np.mean(lost) == pytest.approx(fraction, abs=0.12)


def test_patches_lose_pixels_in_their_ellipse() -> None:
    image = halves()
    patch = Patch(0.5, 0.5, (0.1, 0.2), 0.9)
    apply_loss(image, DepthLoss((), (patch,)), np.random.default_rng(1))
    lost = image.depth == 0.0
    rows, columns = np.nonzero(lost)
    assert lost.sum() > 0.4 * np.pi * 16 * 32
    assert np.abs(columns - 80).max() <= 16
    assert np.abs(rows - 60).max() <= 32


def test_nothing_is_lost_without_dark_parts_and_patches() -> None:
    image = halves()
    random = np.random.default_rng(0)
    before = random.bit_generator.state
    apply_loss(image, DepthLoss(), random)
    assert (image.depth == 2.0).all()
    assert random.bit_generator.state == before


def test_some_people_are_dark_and_some_scenes_shine() -> None:
    random = np.random.default_rng(5)
    losses = [sample_loss(2, RandomStream(random)) for _ in range(300)]
    dark = np.mean([len(loss.dark) for loss in losses]) / 2
    assert dark == pytest.approx(0.15, abs=0.05)
    assert np.mean([bool(loss.patches) for loss in losses]) == pytest.approx(0.25, abs=0.08)
    assert {each.body for loss in losses for each in loss.dark} == {1, 2}
