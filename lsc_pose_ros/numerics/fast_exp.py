"""The Gaussian's exp(-s) without the mathematical library, so that loops over it vectorise."""

from typing import Any

import numpy as np

from lsc_pose_ros.numerics.jit import kernel

_SINGLE: Any = np.float32
# Least-error polynomial for exp(-u) on 0 <= u <= 2 (Chebyshev, degree 7, error 2e-7).
_C0, _C1, _C2, _C3 = map(_SINGLE, (0.999999804, -0.999992786, 0.499935523, -0.166423686))
_C4, _C5, _C6, _C7 = map(_SINGLE, (0.041193375, -0.007812086, 0.001054415, -0.000075168))
_ZERO, _EIGHTH, _END = map(_SINGLE, (0, 0.125, 16))


@kernel
def falloff(s: Any) -> Any:  # noqa: ANN401 - mypy does not know that numba keeps float32
    """Return exp(-s) for s >= 0, and 0 from s = 16 on; both single precision.

    exp(-s) = exp(-s / 8)^8. The error is below 2e-6, and below 1e-4 of exp(-s) itself up to
    s = 9, which is three bandwidths.
    """
    u = min(s, _END) * _EIGHTH
    power = _C0 + u * (_C1 + u * (_C2 + u * (_C3 + u * (_C4 + u * (_C5 + u * (_C6 + u * _C7))))))
    power = power * power
    power = power * power
    power = power * power
    return power if s < _END else _ZERO
