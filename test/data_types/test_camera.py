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

"""The intrinsics from an intrinsic matrix."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import PLUMB_BOB, Intrinsics, Lens
from lsc_pose_ros.errors import InputError

MATRIX = [[500.0, 0.0, 320.0], [0.0, 510.0, 240.0], [0.0, 0.0, 1.0]]


@pytest.mark.parametrize(
    'matrix', [MATRIX, np.array(MATRIX), np.array(MATRIX, np.float32), tuple(np.ravel(MATRIX))]
)
def test_matrix_gives_the_intrinsics(matrix):
    assert Intrinsics.from_matrix(matrix) == Intrinsics(500.0, 510.0, 320.0, 240.0)


def test_lens_is_kept():
    lens = Lens(PLUMB_BOB, (0.1, -0.2))
    assert Intrinsics.from_matrix(MATRIX, lens).lens == lens


@pytest.mark.parametrize(
    'matrix',
    [
        np.zeros((3, 3)),
        np.transpose(MATRIX),
        -np.array(MATRIX),
        np.full((3, 3), np.nan),
        np.eye(4),
        [500.0, 510.0, 320.0, 240.0],
    ],
)
def test_other_matrix_is_refused(matrix):
    with pytest.raises(InputError, match='is not an intrinsic matrix'):
        Intrinsics.from_matrix(matrix)
