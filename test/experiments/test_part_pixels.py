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

"""The pixels of a body, and those of one part."""

import numpy as np
import pytest
from lsc_pose_experiments.shotton.part_forest import PartForest
from lsc_pose_experiments.shotton.part_images import body_image, part_images
from lsc_pose_experiments.shotton.part_pixels import (
    MOST_PIXELS,
    NEGLIGIBLE,
    PartPixels,
    classify_body,
    part_cloud,
)

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import ImageArguments


def one_leaf(part: int) -> PartForest:
    """Return a forest that gives each pixel the class `part`."""
    leaves = np.zeros((1, CLASSES), np.uint8)
    leaves[0, part] = 255
    return PartForest(
        roots=np.zeros(1, np.int32),
        splits=np.zeros((1, 5), np.float32),
        left=np.array([-1], np.int32),
        leaves=leaves,
    )


def images_of(frame) -> ImageArguments:
    return ImageArguments(frame.depth, frame.labels, frame.camera)


def test_image_of_a_body_shows_nothing_else(simple_frames):
    frame = simple_frames[3]
    cut = body_image(images_of(frame), 2)
    assert cut is not None
    depth, camera = cut
    rows, columns = np.nonzero((frame.labels == 2) & (frame.depth > 0))
    assert (depth > 0).sum() == len(rows)
    down, right = int(frame.camera.cy - camera.cy), int(frame.camera.cx - camera.cx)
    np.testing.assert_array_equal(depth[rows - down, columns - right], frame.depth[rows, columns])
    assert body_image(images_of(frame), 7) is None


def test_pixels_are_where_the_camera_measured_them(simple_frames):
    frame = simple_frames[0]
    pixels = classify_body(images_of(frame), 1, one_leaf(5))
    at = np.rint(project(pixels.points, frame.camera)).astype(int)
    np.testing.assert_allclose(frame.depth[at[:, 1], at[:, 0]], pixels.points[:, 2], rtol=1e-6)
    assert (frame.labels[at[:, 1], at[:, 0]] == 1).all()
    assert len(pixels.points) == (frame.labels == 1).sum()
    np.testing.assert_array_equal(pixels.probabilities[:, 5], 1)


def test_body_without_depth_has_no_pixels(simple_frames):
    frame = simple_frames[0]
    depth = np.where(frame.labels == 1, np.float32(0), frame.depth)
    images = ImageArguments(depth, frame.labels, frame.camera)
    assert classify_body(images, 1, one_leaf(5)) is None


def test_parts_are_labelled_on_the_body_only(people):
    frame = people[0]
    (image,) = part_images(frame)
    assert (image.parts[image.depth == 0] == NOT_A_PERSON).all()
    found = np.unique(image.parts)
    assert len(found) > 15
    assert (image.parts[image.depth > 0] != NOT_A_PERSON).mean() > 0.5
    assert not list(part_images(frame._replace(ground_truth=None)))
    nobody = np.full_like(frame.labels, NO_BODY)
    assert not list(part_images(frame._replace(labels=nobody)))


@pytest.mark.parametrize('count', [0, 1, 7, MOST_PIXELS, 3 * MOST_PIXELS + 11])
def test_part_cloud_equals_the_plain_one(count):
    rng = np.random.default_rng(count)
    points = rng.uniform(0.5, 3, (count, 3)).astype(np.float32)
    probabilities = rng.random((count, CLASSES)).astype(np.float32) ** 6
    cloud = part_cloud(PartPixels(points, probabilities), 4)
    kept = np.flatnonzero(probabilities[:, 4] >= NEGLIGIBLE)
    kept = kept[:: max(1, int(np.ceil(len(kept) / MOST_PIXELS)))]
    np.testing.assert_array_equal(np.stack(cloud.votes[:3], axis=1), points[kept])
    np.testing.assert_array_equal(cloud.probability, probabilities[kept, 4])
    wanted = probabilities[kept, 4] * points[kept, 2] ** 2
    np.testing.assert_allclose(cloud.votes.weight, wanted, rtol=1e-6)
    assert len(cloud.probability) <= MOST_PIXELS
