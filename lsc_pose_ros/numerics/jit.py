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

"""Decorators that compile the numeric kernels."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core.registry import CPUDispatcher

from lsc_pose_ros.numerics.interrupts import InterruptSafeDispatcher
from lsc_pose_ros.numerics.kernel_cache import enable_cache

# Depth images hold NaN and infinity, so `nnan` and `ninf` must stay out of this set.
FASTMATH = {'nsz', 'arcp', 'contract', 'afn', 'reassoc'}

_Parameters = ParamSpec('_Parameters')
_Result = TypeVar('_Result')


def kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` for one core; it releases the GIL, and its machine code is cached."""
    return _compile(function, parallel=False, fastmath=FASTMATH)


def exact_kernel(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Compile `function` like `kernel`, with each operation rounded in the order written.

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
    if isinstance(compiled, CPUDispatcher):  # not with NUMBA_DISABLE_JIT
        compiled.__class__ = InterruptSafeDispatcher
    enable_cache(compiled, function)
    result: Callable[_Parameters, _Result] = compiled
    return result
