"""Waits for conditions, so that no test depends on how fast or how busy the computer is."""

import time
from collections.abc import Callable

PATIENCE = 600.0
"""Seconds until a test gives up, far more than what it waits for takes on a busy computer."""

COMPILING_PATIENCE = 1800.0
"""The same, if a process that compiles many kernels is waited for."""

_POLL_PERIOD = 0.01


def wait_until(condition: Callable[[], object]) -> bool:
    """Wait until a condition holds, at most `PATIENCE`; return whether it does."""
    return _becomes(condition, PATIENCE)


def stays(condition: Callable[[], object], seconds: float = 1.0) -> bool:
    """Return whether a condition holds during all of `seconds`."""
    return not _becomes(lambda: not condition(), seconds)


def _becomes(condition: Callable[[], object], seconds: float) -> bool:
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(_POLL_PERIOD)
    return True
