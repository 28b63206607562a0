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

"""Tests the visibility of joints: in small images by hand, and in synthetic scenes."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.visibility import HIDDEN, HIDDEN_BY_BODY, OUTSIDE, SEEN
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_scenes
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.framing import Margins
from lsc_pose_ros.synthetic.scene.joint_visibility import joint_visibility
from lsc_pose_ros.synthetic.scene.pixel_codes import pixel_codes

CAMERA = Intrinsics(100.0, 100.0, 49.5, 39.5)
CODES = pixel_codes(1, np.arange(1, 21, dtype=np.int32))
KNEE = JOINT_NUMBERS['l_knee']
OTHER_KNEE = JOINT_NUMBERS['r_knee']


def image_of(code: int) -> DepthImage:
    """Return an image in which all pixels show one code at 2 m."""
    return DepthImage(np.full((80, 100), 2.0, np.float32), np.full((80, 100), code, np.int32))


def visibility_of(alone: DepthImage, image: DepthImage, margins: Margins) -> int:
    """Return the visibility of a left knee in the middle of the image."""
    joints = np.tile([0.0, 0.0, 2.0], (20, 1))
    return int(joint_visibility(joints, CODES, alone, image, CAMERA, margins)[KNEE])


def test_joint_is_seen_if_its_part_is_visible_near_it() -> None:
    own = image_of(CODES[KNEE])
    assert visibility_of(own, own, Margins()) == SEEN
    half = DepthImage(own.depth, own.labels.copy())
    half.labels[:, :50] = NO_BODY
    assert visibility_of(own, half, Margins()) == SEEN


def test_joint_is_hidden_by_what_is_in_front_of_it() -> None:
    own, other_part = image_of(CODES[KNEE]), image_of(CODES[OTHER_KNEE])
    nobody, other_body = image_of(NO_BODY), image_of(int(CODES[KNEE]) + 32)
    assert visibility_of(own, nobody, Margins()) == HIDDEN
    assert visibility_of(own, other_body, Margins()) == HIDDEN
    assert visibility_of(other_part, other_part, Margins()) == HIDDEN_BY_BODY
    # Something else hides the limb that hides the joint.
    assert visibility_of(other_part, nobody, Margins()) == HIDDEN


def test_joint_in_a_margin_or_beyond_the_edge_is_outside() -> None:
    own = image_of(CODES[KNEE])
    assert visibility_of(own, own, Margins(left=52)) == OUTSIDE
    assert visibility_of(own, own, Margins(bottom=42)) == OUTSIDE
    assert visibility_of(own, own, Margins(left=40, right=40, top=30, bottom=30)) == SEEN
    joints = np.tile([1.2, 0.0, 2.0], (20, 1))
    assert (joint_visibility(joints, CODES, own, own, CAMERA, Margins()) == OUTSIDE).all()
    behind = np.tile([0.0, 0.0, -2.0], (20, 1))
    assert (joint_visibility(behind, CODES, own, own, CAMERA, Margins()) == OUTSIDE).all()


@pytest.mark.parametrize('furniture', [False, True])
def test_scenes_agree_with_their_visibility(furniture: bool) -> None:  # noqa: FBT001
    settings = SyntheticSettings(
        frames=40, clip_length=4, people=2, noise='none', furniture=furniture, distance=(2.0, 5.0)
    )
    counts = np.zeros(4, int)
    for scene in synthetic_scenes(settings):
        assert scene.frame.ground_truth is not None
        assert scene.visibility.shape == (2, len(JOINT_NAMES))
        assert scene.visibility.dtype == np.uint8
        counts += np.bincount(scene.visibility.ravel(), minlength=4)
        for number, positions in enumerate(scene.frame.ground_truth.positions):
            seen = scene.visibility[number] == SEEN
            columns, rows = np.rint(project(positions[seen], scene.frame.camera)).astype(int).T
            own = (scene.frame.labels == 1 + number)[:, :, None] & (
                scene.parts[:, :, None] == 1 + np.flatnonzero(seen)
            )
            assert own.any(axis=(0, 1)).all()
            assert (scene.visibility[number][~seen] != SEEN).all()
            assert ((rows >= 0) & (columns >= 0)).all()
    assert counts[SEEN] > 0.4 * counts.sum()
    assert (counts[HIDDEN] > 0.1 * counts.sum()) == furniture
    assert (counts[OUTSIDE] > 0.02 * counts.sum()) == furniture
    assert counts[HIDDEN_BY_BODY] > 0.03 * counts.sum()
