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

"""A thread that works on the newest item: the node keeps up with a camera of any rate."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Item = TypeVar('Item')


class Worker(Generic[Item]):
    """A thread with a slot for one waiting item; a newer item replaces the waiting one.

    The delay of a result is bounded by the work on two items, and the memory does not grow,
    whatever the rate of the items. The last submitted item is always worked on.
    """

    def __init__(
        self, work: Callable[[Item], None], failed: Callable[[Exception], None], name: str
    ) -> None:
        """Make a worker; `start` starts it.

        Args:
            work: is called with one item at a time, in the worker's thread.
            failed: is called in the worker's thread with an exception of `work`; the worker then
                continues with the next item.
            name: the name of the thread.
        """
        self._changed = threading.Condition()
        self._waiting: list[Item] = []  # at most one
        self._closed = False
        self._replaced = 0
        # Only the thread holds the callables, until it ends: they may refer to this worker.
        self._thread = threading.Thread(
            target=self._run, args=(work, failed), name=name, daemon=True
        )

    @property
    def replaced(self) -> int:
        """The number of items that were replaced by newer ones before the work on them began."""
        return self._replaced

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def submit(self, item: Item) -> None:
        """Put `item` into the slot; never blocks."""
        with self._changed:
            self._replaced += len(self._waiting)
            self._waiting[:] = [item]
            self._changed.notify()

    def close(self, timeout: float = 5.0) -> bool:
        """End the thread after its current item; a waiting item is dropped.

        Args:
            timeout: seconds to wait for the thread.

        Returns:
            Whether the thread has ended.
        """
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self, work: Callable[[Item], None], failed: Callable[[Exception], None]) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closed)
                if self._closed:
                    return
                item = self._waiting.pop()
            try:
                work(item)
            except Exception as error:  # noqa: BLE001 - a bad frame must not end the node
                failed(error)
            del item  # an image must not stay in memory while the thread waits
