"""How the numeric kernels are compiled: one decorator for all of them."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba

# Depth images hold NaN and infinity, so `nnan` and `ninf` must stay out of this set.
FASTMATH = {'nsz', 'arcp', 'contract', 'afn', 'reassoc'}

_Parameters = ParamSpec('_Parameters')
_Result = TypeVar('_Result')


def kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` for one core; it releases the GIL and its code is kept on disk."""
    compiled: Callable[_Parameters, _Result] = numba.njit(
        cache=True, nogil=True, error_model='numpy', fastmath=FASTMATH
    )(function)
    return compiled


def parallel_kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` so that its `numba.prange` loops use all cores; for training only."""
    compiled: Callable[_Parameters, _Result] = numba.njit(
        cache=True, nogil=True, error_model='numpy', fastmath=FASTMATH, parallel=True
    )(function)
    return compiled
