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

"""Skeletons and their points in a PointCloud2."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.skeletons import (
    GROUND_TRUTH_DTYPE,
    POINT_DTYPE,
    Skeletons,
    no_skeletons,
    pack,
    unpack,
)


def test_point_has_twenty_bytes_in_the_published_order():
    assert POINT_DTYPE.itemsize == 20
    offsets = {name: field[1] for name, field in POINT_DTYPE.fields.items()}
    assert offsets == {'x': 0, 'y': 4, 'z': 8, 'confidence': 12, 'body': 16, 'joint': 18}


@pytest.mark.parametrize('bodies', [0, 1, 3])
def test_unpack_is_the_inverse_of_pack(bodies):
    rng = np.random.default_rng(bodies)
    positions = rng.normal(0, 1, (bodies, 5, 3)).astype(np.float32)
    positions[:, 2] = np.nan
    skeletons = Skeletons(
        np.arange(7, 7 + bodies).astype(np.uint16),
        np.array([0, 2, 5, 7, 19], np.uint16),
        positions,
        rng.random((bodies, 5)).astype(np.float32),
    )
    again = unpack(np.frombuffer(pack(skeletons).tobytes(), POINT_DTYPE).reshape(bodies, 5))
    np.testing.assert_array_equal(again.positions, positions)
    np.testing.assert_array_equal(again.confidence, skeletons.confidence)
    np.testing.assert_array_equal(again.bodies, skeletons.bodies)
    if bodies:
        np.testing.assert_array_equal(again.joints, skeletons.joints)


def test_no_skeletons_are_an_empty_cloud_with_one_column_per_joint():
    assert pack(no_skeletons(np.arange(17, dtype=np.uint16))).shape == (0, 17)


def test_visibility_comes_back():
    rng = np.random.default_rng(1)
    skeletons = Skeletons(
        np.array([3, 7], np.uint16),
        np.arange(5, dtype=np.uint16),
        rng.normal(size=(2, 5, 3)).astype(np.float32),
        np.ones((2, 5), np.float32),
        rng.integers(0, 4, (2, 5)).astype(np.uint8),
    )
    points = np.frombuffer(pack(skeletons).tobytes(), GROUND_TRUTH_DTYPE).reshape(2, 5)
    for name, value in skeletons._asdict().items():
        np.testing.assert_array_equal(getattr(unpack(points), name), value, strict=True)
