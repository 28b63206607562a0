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
