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

"""Fast functions against those of numpy."""

import numpy as np
import pytest

from lsc_pose_ros.numerics.fast_math import exp_neg, log2_from_bits, polynomial


def test_exp_neg_has_the_documented_error() -> None:
    s = np.linspace(0, 16, 4001, endpoint=False).astype(np.float32)
    found = np.array([exp_neg(value) for value in s])
    expected = np.exp(-s.astype(float))
    assert np.abs(found - expected).max() < 2e-6
    assert np.abs(found / expected - 1)[s <= 9].max() < 1e-4
    assert exp_neg(np.float32(0)) == pytest.approx(1, abs=2e-6)


@pytest.mark.parametrize('s', [16, 1e3, 1e30, np.inf])
def test_exp_neg_is_zero_from_16_on(s: float) -> None:
    assert exp_neg(np.float32(s)) == 0


def test_log2_has_the_documented_error():
    values = np.concatenate(
        [np.geomspace(1e-30, 1e30, 2000), np.linspace(0.5, 4, 2000), 2.0 ** np.arange(-20, 20)]
    ).astype(np.float32)
    found = [log2_from_bits(bits) for bits in values.view(np.int32)]
    np.testing.assert_allclose(found, np.log2(values.astype(float)), rtol=2e-7, atol=2e-5)


def test_zero_times_its_logarithm_is_zero():
    assert np.float32(0) * log2_from_bits(np.int32(0)) == 0


def test_polynomial_takes_the_constant_first():
    coefficients = tuple(map(np.float32, (3, -2, 0.5)))
    assert polynomial(np.float32(2), coefficients) == pytest.approx(3 - 4 + 2)
