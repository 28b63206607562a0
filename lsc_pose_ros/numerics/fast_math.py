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

"""Elementary functions in single precision without the math library, so that loops vectorise."""

from typing import Any

import numpy as np

from lsc_pose_ros.numerics.jit import kernel

_SINGLE: Any = np.float32

# Least-error polynomial for exp(-u) on 0 <= u <= 2 (Chebyshev, degree 7, error 2e-7).
_C0, _C1, _C2, _C3 = map(_SINGLE, (0.999999804, -0.999992786, 0.499935523, -0.166423686))
_C4, _C5, _C6, _C7 = map(_SINGLE, (0.041193375, -0.007812086, 0.001054415, -0.000075168))
_ZERO, _EIGHTH, _END = map(_SINGLE, (0, 0.125, 16))

# log2(1 + m) / m for 0 <= m <= 1, the constant first (Chebyshev).
_LOG2 = tuple(
    map(_SINGLE, (1.442681468, -0.720358773, 0.468658879, -0.301638010, 0.144471096, -0.033822046))
)


@kernel
def exp_neg(s: Any) -> Any:  # noqa: ANN401 - mypy does not know that numba keeps float32
    """Return exp(-s), the fall of a Gaussian.

    exp(-s) = exp(-s / 8)^8. The absolute error is below 2e-6; the relative error is below 1e-4
    up to s = 9, which is three bandwidths.

    Args:
        s: a float32, not negative.

    Returns:
        A float32; 0 if `s` is 16 or more.
    """
    u = min(s, _END) * _EIGHTH
    power = _C0 + u * (_C1 + u * (_C2 + u * (_C3 + u * (_C4 + u * (_C5 + u * (_C6 + u * _C7))))))
    power = power * power
    power = power * power
    power = power * power
    return power if s < _END else _ZERO


@kernel
def log2_from_bits(bits: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return log2 of a positive float32, to 2e-5.

    Args:
        bits: the number's memory read as an int32; the bits of 0 give -127.
    """
    exponent = _SINGLE((bits >> 23) - 127)
    m = _SINGLE(bits & 0x7FFFFF) * _SINGLE(2.0**-23)
    return exponent + m * polynomial(m, _LOG2)


@kernel
def polynomial(x: Any, coefficients: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return the value of a polynomial at `x` (Horner's rule).

    Args:
        x: where.
        coefficients: a tuple, the constant first.
    """
    value = coefficients[-1]
    for k in range(len(coefficients) - 2, -1, -1):
        value = coefficients[k] + x * value
    return value
