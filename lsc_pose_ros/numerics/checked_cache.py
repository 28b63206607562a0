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

"""Numba's cache of machine code with checks that an installed package needs.

This is the only module that uses names that numba does not document.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from numba import config
from numba.core.caching import FunctionCache, IndexDataCacheFile

from lsc_pose_ros.numerics.source_hash import source_hash

if sys.platform != 'win32':
    import fcntl

_LOCK = 'kernels.lock'


class CheckedCache(FunctionCache):
    """The cache of one kernel.

    Numba's own cache keeps code apart by argument types, processor, and the versions of Python
    and numba. This one also

    - recompiles a kernel when another file that it uses has changed, e.g. after an update;
    - keeps code with and without checks of the indices (NUMBA_BOUNDSCHECK) apart;
    - recompiles a kernel when its cached file is damaged, and works with a full disk;
    - lets one process at a time read or write, because an entry is two files.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        """Find the folder.

        Raises:
            RuntimeError: no folder can be written.
            OSError: the function has no file.
            AttributeError: this version of numba builds its cache differently.
        """
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp(), source_hash(function.__module__)
        self._cache_file = IndexDataCacheFile(self.cache_path, self._impl.filename_base, stamp)

    def _index_key(self, sig: object, codegen: object) -> object:
        return super()._index_key(sig, codegen), bool(getattr(config, 'BOUNDSCHECK', False))

    def load_overload(self, sig: object, target_context: object) -> object:
        """Return the code for a signature, or None if it is not cached."""
        try:
            with self._locked():
                return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001 - a damaged pickle can raise anything
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: object, data: object) -> None:
        """Save the code for a signature; on a full disk, do nothing."""
        with suppress(OSError), self._locked():
            super().save_overload(sig, data)

    @contextmanager
    def _locked(self) -> Iterator[None]:
        with Path(self.cache_path, _LOCK).open('a', encoding='ascii') as lock:
            if sys.platform != 'win32':
                with suppress(OSError):  # not every network file system can lock
                    fcntl.flock(lock, fcntl.LOCK_EX)
            yield
