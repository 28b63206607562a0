"""The logarithm without the mathematical library, so that loops over it vectorise."""

from typing import Any

import numpy as np

from lsc_pose_ros.numerics.jit import kernel

_SINGLE: Any = np.float32

# log2(1 + m) / m for 0 <= m <= 1, the constant first (Chebyshev).
_LOGARITHM = tuple(
    map(_SINGLE, (1.442681468, -0.720358773, 0.468658879, -0.301638010, 0.144471096, -0.033822046))
)


@kernel
def polynomial(x: Any, coefficients: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return the value at `x` of a polynomial, the constant coefficient first (Horner's rule)."""
    value = coefficients[-1]
    for k in range(len(coefficients) - 2, -1, -1):
        value = coefficients[k] + x * value
    return value


@kernel
def log2_of_bits(bits: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return log2 of the positive single-precision number that has these bits, to 2e-5.

    Bits are what the number's memory holds as an int32; those of 0 give -127.
    """
    exponent = _SINGLE((bits >> 23) - 127)
    m = _SINGLE(bits & 0x7FFFFF) * _SINGLE(2.0**-23)
    return exponent + m * polynomial(m, _LOGARITHM)
