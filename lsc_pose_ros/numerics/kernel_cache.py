"""Where the kernels' machine code is kept between runs: numba's cache, made safe to install."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache, IndexDataCacheFile

from lsc_pose_ros.numerics.source_hash import source_stamp

if sys.platform != 'win32':
    import fcntl

_LOCK = 'kernels.lock'


def cache_directory() -> Path | None:
    """Return the folder that keeps the machine code of the kernels in this folder.

    It is the first that can be written: below what NUMBA_CACHE_DIR names, `__pycache__` beside
    the sources, below the user's own cache. None where none can: every process compiles anew.
    """
    try:
        return Path(KernelCache(cache_directory).cache_path)
    except (RuntimeError, OSError):
        return None


def describe_cache() -> str:
    """Return where the machine code is kept, and why there, for people to read."""
    directory = cache_directory()
    if directory is None:
        return (
            'kept nowhere, so that every start takes as long: neither the installation nor the '
            "user's cache can be written; name a folder that can in NUMBA_CACHE_DIR"
        )
    if getattr(numba.config, 'CACHE_DIR', '') or directory.parent == Path(__file__).parent:
        return f'kept in {directory}'
    return f'kept in {directory}, for the installation is read-only'


class KernelCache(FunctionCache):
    """The cache of one kernel.

    Numba's own keeps code apart by types, processor, and the versions of Python and numba. This
    one in addition

    - notices what has changed in other files that the kernel uses, as an update changes them;
    - compiles anew what a damaged file held, and goes on where the disk is full;
    - lets one process at a time read or write, for an entry is two files.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        """Find the folder.

        Raises:
            RuntimeError: there is none that can be written.
            OSError: the function has no file.
        """
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp(), source_stamp(function.__module__)
        self._cache_file = IndexDataCacheFile(self.cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: object, target_context: object) -> object:
        """Return the code for a signature, None where it is not kept."""
        try:
            with self._alone():
                return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001 - a damaged pickle can raise anything
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: object, data: object) -> None:
        """Keep the code for a signature if that is possible."""
        with suppress(OSError), self._alone():
            super().save_overload(sig, data)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        with Path(self.cache_path, _LOCK).open('a', encoding='ascii') as lock:
            if sys.platform != 'win32':
                with suppress(OSError):  # not every network's file system can lock
                    fcntl.flock(lock, fcntl.LOCK_EX)
            yield
