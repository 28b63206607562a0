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

"""The numbers of segmented bodies in labelled recordings."""

import numpy as np

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.segmentation.ground_truth_numbers import numbered_as_ground_truth

CAMERA = Intrinsics(60.0, 61.0, 31.5, 23.5)


def skeletons(*bodies: tuple[int, list[tuple[float, float]]]) -> Skeletons:
    """Return skeletons with joints at 2 m at the given pixels (column, row); NaN is unlabelled."""
    pixels = np.array([places for _, places in bodies], float)
    depth = np.full(pixels.shape[:2], 2.0)
    positions = back_project(pixels[..., 0], pixels[..., 1], depth, CAMERA)
    numbers = np.array([number for number, _ in bodies], np.uint16)
    joints = np.arange(pixels.shape[1], dtype=np.uint16)
    return Skeletons(numbers, joints, positions, np.ones(depth.shape, np.float32))


def labels_of_three() -> np.ndarray:
    labels = np.full((48, 64), NO_BODY, np.int32)
    labels[5:40, 2:15], labels[5:40, 20:35], labels[5:40, 45:60] = 1, 2, 3
    return labels


def test_bodies_have_the_numbers_of_the_skeletons_on_them() -> None:
    nan = float('nan')
    ground_truth = skeletons(
        (7, [(50, 10), (50, 20), (25, 30)]),  # one hand before the other body
        (4, [(25, 10), (nan, nan), (200, -3)]),
    )
    before = labels_of_three()
    numbered = numbered_as_ground_truth(before, ground_truth, CAMERA)
    assert (numbered[before == 3] == 7).all()
    assert (numbered[before == 2] == 4).all()
    (other,) = set(numbered[before == 1].tolist())
    assert other not in {4, 7, NO_BODY}
    assert ((numbered == NO_BODY) == (before == NO_BODY)).all()


def test_nobody_and_no_skeleton() -> None:
    nobody = np.full((48, 64), NO_BODY, np.int32)
    one = skeletons((1, [(5, 5)]))
    np.testing.assert_array_equal(numbered_as_ground_truth(nobody, one, CAMERA), nobody)
    none = one._replace(
        bodies=one.bodies[:0], positions=one.positions[:0], confidence=one.confidence[:0]
    )
    found = numbered_as_ground_truth(labels_of_three(), none, CAMERA)
    assert len(np.unique(found)) == 4
