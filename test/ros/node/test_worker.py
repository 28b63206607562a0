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

"""The worker: the newest item wins."""

import threading

import pytest
from waiting import PATIENCE, wait_until

from lsc_pose_ros.ros.node.worker import Worker


class Slow:
    """Work that waits to be let go on."""

    def __init__(self) -> None:
        self.begun = threading.Semaphore(0)
        self.go_on = threading.Semaphore(0)
        self.done: list[int] = []

    def __call__(self, item: int) -> None:
        self.begun.release()
        assert self.go_on.acquire(timeout=PATIENCE)
        self.done.append(item)


def ignore(_error: Exception) -> None:
    pass


def wait_for(done: list[int], count: int) -> None:
    assert wait_until(lambda: len(done) >= count)


def test_newest_item_replaces_those_that_wait() -> None:
    slow = Slow()
    worker = Worker(slow, ignore, 'test')
    worker.start()
    worker.submit(0)
    assert slow.begun.acquire(timeout=PATIENCE)
    for item in range(1, 1000):
        worker.submit(item)
    slow.go_on.release(2)
    wait_for(slow.done, 2)
    assert slow.done == [0, 999]
    assert worker.replaced == 998
    assert worker.close()


def test_every_item_is_worked_on_in_order_where_there_is_time() -> None:
    done: list[int] = []
    worker = Worker(done.append, ignore, 'test')
    worker.start()
    for item in range(200):
        worker.submit(item)
        wait_for(done, item + 1)
    assert done == list(range(200))
    assert worker.replaced == 0
    worker.close()


def test_item_submitted_before_the_start_is_worked_on() -> None:
    done: list[int] = []
    worker = Worker(done.append, ignore, 'test')
    worker.submit(7)
    worker.start()
    wait_for(done, 1)
    assert done == [7]
    worker.close()


def test_failure_is_told_and_work_goes_on() -> None:
    done: list[int] = []
    errors: list[Exception] = []

    def work(item: int) -> None:
        if item == 0:
            raise ValueError(item)
        done.append(item)

    worker = Worker(work, errors.append, 'test')
    worker.start()
    worker.submit(0)
    assert wait_until(lambda: errors)
    worker.submit(1)
    wait_for(done, 1)
    assert done == [1]
    assert [str(error) for error in errors] == ['0']
    worker.close()


def test_close_waits_for_the_item_in_work_and_gives_up_the_waiting_one() -> None:
    slow = Slow()
    worker = Worker(slow, ignore, 'test')
    worker.start()
    worker.submit(0)
    assert slow.begun.acquire(timeout=PATIENCE)
    worker.submit(1)
    assert not worker.close(timeout=0.05)
    slow.go_on.release(2)
    assert worker.close()
    assert slow.done == [0]


@pytest.mark.parametrize('started', [False, True])
def test_close_without_work(*, started: bool) -> None:
    worker = Worker(print, ignore, 'test')
    if started:
        worker.start()
    assert worker.close()


def test_item_is_not_held_after_the_work() -> None:
    import weakref  # noqa: PLC0415

    class Item:
        pass

    gone = threading.Event()
    worker: Worker[Item] = Worker(lambda _item: None, ignore, 'test')
    worker.start()
    item = Item()
    weakref.finalize(item, gone.set)
    worker.submit(item)
    del item
    assert gone.wait(PATIENCE)
    worker.close()
