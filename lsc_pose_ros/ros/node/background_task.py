"""Work that takes long, done so that the process can still be told to stop."""

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TypeVar

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException

Result = TypeVar('Result')

_POLL_PERIOD = 0.05


def run_aside(work: Callable[[], Result], context: Context) -> Result:
    """Do `work` in a thread of its own, and return or raise what it does.

    Kernels that are being compiled cannot be interrupted, so that the caller leaves them alone
    when the process is told to stop.

    Args:
        work: what is to be done.
        context: shut down where the process is told to stop.

    Raises:
        ExternalShutdownException: the process is told to stop; the thread still runs.
    """
    outcome: Future[Result] = Future()

    def run() -> None:
        try:
            outcome.set_result(work())
        except BaseException as error:  # noqa: BLE001 - the caller raises it
            outcome.set_exception(error)

    threading.Thread(target=run, name='aside', daemon=True).start()
    while not wait([outcome], _POLL_PERIOD).done:
        if not context.ok():
            raise ExternalShutdownException
    return outcome.result()
