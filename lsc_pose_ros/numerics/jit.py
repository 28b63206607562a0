"""How the numeric kernels are compiled: one decorator for all of them."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, ParamSpec, TypeVar

import numba

from lsc_pose_ros.numerics.kernel_cache import KernelCache

# Depth images hold NaN and infinity, so `nnan` and `ninf` must stay out of this set.
FASTMATH = {'nsz', 'arcp', 'contract', 'afn', 'reassoc'}

_Parameters = ParamSpec('_Parameters')
_Result = TypeVar('_Result')


def kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` for one core; it releases the GIL and its code is kept on disk."""
    return _compile(function, parallel=False, fastmath=FASTMATH)


def exact_kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` as `kernel` does, but to the last bit as it is written.

    Every compiler and processor then gives the same numbers.
    """
    return _compile(function, parallel=False, fastmath=set())


def parallel_kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` so that its `numba.prange` loops use all cores; for training only."""
    return _compile(function, parallel=True, fastmath=FASTMATH)


def _compile(
    function: Callable[_Parameters, _Result], *, parallel: bool, fastmath: set[str]
) -> Callable[_Parameters, _Result]:
    compiled: Any = numba.njit(
        nogil=True, error_model='numpy', fastmath=fastmath, parallel=parallel
    )(function)
    with suppress(RuntimeError, OSError):  # nowhere to keep it: every process compiles anew
        # What `cache=True` does with numba's own cache.
        compiled._cache = KernelCache(function)  # noqa: SLF001
    result: Callable[_Parameters, _Result] = compiled
    return result
