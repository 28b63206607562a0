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

"""The cache of the kernels' machine code: which one is used, and where it is."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

try:
    from lsc_pose_ros.numerics.checked_cache import CheckedCache
except ImportError:  # another version of numba names its cache's parts differently
    CheckedCache = None  # type: ignore[assignment,misc]


def enable_cache(compiled: Any, function: Callable[..., Any]) -> None:  # noqa: ANN401
    """Keep the machine code of a kernel on disk between processes.

    `CheckedCache` is used, or numba's own cache if this version of numba does not support it.
    If no folder can be written, the kernel is compiled in every process.

    Args:
        compiled: what `numba.njit` returned for `function`.
        function: the kernel's source.
    """
    if compiled is function:  # NUMBA_DISABLE_JIT: there is no machine code
        return
    try:
        try:
            # This is what `cache=True` does with numba's own cache.
            compiled._cache = CheckedCache(function)  # noqa: SLF001
        except (AttributeError, TypeError):  # it is None, or built on what numba has changed
            compiled.enable_caching()
    except (RuntimeError, OSError):  # no folder can be written, or the function has no file
        return


def cache_directory() -> Path | None:
    """Return the folder that holds the machine code of the kernels in this folder.

    It is the first of these that can be written: below the folder that NUMBA_CACHE_DIR names,
    `__pycache__` beside the sources, below the user's cache. None if none of them can be written:
    the kernels are then compiled in every process.
    """
    compiled: Any = numba.njit(_any_kernel)
    enable_cache(compiled, _any_kernel)
    path = None if compiled is _any_kernel else compiled.stats.cache_path
    return Path(path) if path else None


def describe_cache() -> str:
    """Return a phrase for users: where the machine code is kept, and why there."""
    directory = cache_directory()
    if directory is None:
        return (
            'not kept, so every start takes as long: neither the installation nor the '
            "user's cache can be written; name a folder that can in NUMBA_CACHE_DIR"
        )
    if getattr(numba.config, 'CACHE_DIR', '') or directory.parent == Path(__file__).parent:
        return f'kept in {directory}'
    return f'kept in {directory}, because the installation is read-only'


def _any_kernel() -> None:
    """Stand for the kernels when their folder is looked for."""
