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

"""Exact kernels give the same bits as the source."""

import numpy as np

from lsc_pose_ros.numerics.jit import exact_kernel


@exact_kernel
def cancel(large: float, small: float) -> float:
    return (large + small) - large


@exact_kernel
def blend(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    out = np.empty_like(a)
    for index in range(len(a)):
        out[index] = a[index] * b[index] + c[index]
    return out


def test_exact_kernels_keep_the_order_of_operations() -> None:
    assert cancel(1e16, 1.0) == 0.0


def test_exact_kernels_round_after_every_operation() -> None:
    a, b, c = np.random.default_rng(0).random((3, 10_000), np.float32)
    np.testing.assert_array_equal(blend(a, b, c), a * b + c)
