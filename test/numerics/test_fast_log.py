import numpy as np
import pytest

from lsc_pose_ros.numerics.fast_log import log2_of_bits, polynomial


def test_log2_to_the_stated_error():
    values = np.concatenate(
        [np.geomspace(1e-30, 1e30, 2000), np.linspace(0.5, 4, 2000), 2.0 ** np.arange(-20, 20)]
    ).astype(np.float32)
    found = [log2_of_bits(bits) for bits in values.view(np.int32)]
    np.testing.assert_allclose(found, np.log2(values.astype(float)), rtol=2e-7, atol=2e-5)


def test_zero_times_its_logarithm_is_zero():
    assert np.float32(0) * log2_of_bits(np.int32(0)) == 0


def test_polynomial_is_horners():
    coefficients = tuple(map(np.float32, (3, -2, 0.5)))
    assert polynomial(np.float32(2), coefficients) == pytest.approx(3 - 4 + 2)
