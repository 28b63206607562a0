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

"""Live depth images, masks and camera infos are joined, and counted."""

import numpy as np
import pytest

from lsc_pose_ros.synchronization.live_synchronizer import REWIND_NS, LiveSynchronizer
from lsc_pose_ros.synchronization.synchronizer import DropCounts, SynchronizerSettings

FRAME = 33_000_000

# No image has this stamp: each image takes the newest camera info.
OTHER_STAMP = -1


class Inbox:
    """A synchronizer, and the frames that it has delivered."""

    def __init__(self, slop: int = 0, capacity: int = 5, *, with_masks: bool = True) -> None:
        self.delivered: list[tuple[str, str | None, str]] = []
        self.synchronizer: LiveSynchronizer[str, str, str] = LiveSynchronizer(
            SynchronizerSettings(slop, capacity, waiting=capacity, with_masks=with_masks),
            lambda frame: self.delivered.append((frame.depth, frame.mask, frame.camera_info)),
        )


@pytest.mark.parametrize('mask_first', [False, True])
def test_equal_stamps_make_a_pair_in_either_order(*, mask_first: bool) -> None:
    inbox = Inbox()
    synchronizer = inbox.synchronizer
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    if mask_first:
        synchronizer.add_mask(1, 'mask')
        synchronizer.add_depth(1, 'depth')
    else:
        synchronizer.add_depth(1, 'depth')
        synchronizer.add_mask(1, 'mask')
    assert inbox.delivered == [('depth', 'mask', 'info')]
    assert (synchronizer.depth, synchronizer.masks) == (1, 1)
    assert (synchronizer.camera_infos, synchronizer.pairs) == (1, 1)


def test_newest_camera_info_goes_with_a_pair() -> None:
    inbox = Inbox()
    for number in range(3):
        inbox.synchronizer.add_camera_info(number, f'info{number}')
        inbox.synchronizer.add_depth(number, f'depth{number}')
        inbox.synchronizer.add_mask(number, f'mask{number}')
    assert inbox.delivered[2] == ('depth2', 'mask2', 'info2')


def test_camera_info_that_comes_once_serves_all_pairs() -> None:
    inbox = Inbox()
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in range(10):
        inbox.synchronizer.add_depth(number, 'depth')
        inbox.synchronizer.add_mask(number, 'mask')
    assert len(inbox.delivered) == 10


def test_newest_pair_waits_for_the_first_camera_info() -> None:
    inbox = Inbox()
    for number in range(3):
        inbox.synchronizer.add_depth(number, f'depth{number}')
        inbox.synchronizer.add_mask(number, f'mask{number}')
    assert inbox.delivered == []
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    assert inbox.delivered == [('depth2', 'mask2', 'info')]


def test_slop_joins_stamps_that_differ() -> None:
    inbox = Inbox(slop=1000)
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    inbox.synchronizer.add_depth(FRAME, 'depth')
    inbox.synchronizer.add_mask(FRAME + 1001, 'late')
    assert inbox.delivered == []
    inbox.synchronizer.add_mask(FRAME + 1000, 'mask')
    assert inbox.delivered == [('depth', 'mask', 'info')]


def test_masks_later_than_the_queue_is_long_find_nothing() -> None:
    inbox = Inbox(capacity=5)
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in range(20):
        inbox.synchronizer.add_depth(number, 'depth')
        if number >= 5:
            inbox.synchronizer.add_mask(number - 5, 'mask')
    assert inbox.delivered == []
    assert inbox.synchronizer.pairs == 0


def test_frames_of_a_recording_that_is_played_again_are_delivered_again() -> None:
    inbox = Inbox(capacity=100)
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for _ in range(3):
        for number in range(30):
            inbox.synchronizer.add_depth(number * FRAME, 'depth')
            inbox.synchronizer.add_mask(number * FRAME, 'mask')
    assert len(inbox.delivered) == 90
    assert inbox.synchronizer.rewinds == 2


def test_image_that_comes_a_little_late_is_no_rewind() -> None:
    inbox = Inbox()
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for stamp in (REWIND_NS, 2 * REWIND_NS, REWIND_NS + 1):
        inbox.synchronizer.add_depth(stamp, 'depth')
        inbox.synchronizer.add_mask(stamp, 'mask')
    assert inbox.synchronizer.rewinds == 0
    assert len(inbox.delivered) == 2


def test_pairs_are_delivered_in_order_and_late_ones_are_counted() -> None:
    inbox = Inbox()
    synchronizer = inbox.synchronizer
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in (0, 1, 2):
        synchronizer.add_depth(number * FRAME, f'depth{number}')
    for number in (0, 2, 1):
        synchronizer.add_mask(number * FRAME, f'mask{number}')
    assert [pair[0] for pair in inbox.delivered] == ['depth0', 'depth2']
    assert synchronizer.out_of_order == 1
    assert synchronizer.dropped == DropCounts(unmatched_depth=1, late=1)


def test_duplicates_are_left_out_and_counted() -> None:
    inbox = Inbox()
    synchronizer = inbox.synchronizer
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in range(3):
        for _ in range(2):
            synchronizer.add_depth(number * FRAME, 'depth')
            synchronizer.add_mask(number * FRAME, 'mask')
    assert len(inbox.delivered) == synchronizer.pairs == 3
    assert synchronizer.dropped == DropCounts(duplicates=6)
    assert synchronizer.out_of_order == 0


def test_masks_slower_than_depth_give_as_many_pairs() -> None:
    inbox = Inbox(capacity=30)
    inbox.synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in range(90):
        inbox.synchronizer.add_depth(number * FRAME, str(number))
        if number >= 8 and number % 3 == 0:
            inbox.synchronizer.add_mask((number - 8) * FRAME, str(number - 8))
    assert [int(pair[0]) for pair in inbox.delivered] == list(range(1, 82, 3))
    assert all(depth == mask for depth, mask, _ in inbox.delivered)
    assert inbox.synchronizer.dropped == DropCounts(unmatched_depth=2 * 26 + 1)
    assert inbox.synchronizer.missing == 0


def test_missing_stamps_are_counted() -> None:
    inbox = Inbox()
    random = np.random.default_rng(0)
    came = random.random(600) < 0.4
    came[[0, -1]] = True
    for number in np.flatnonzero(came):
        jitter = random.integers(-FRAME // 10, FRAME // 10)
        inbox.synchronizer.add_depth(int(10**18 + number * FRAME + jitter), 'depth')
    assert inbox.synchronizer.missing == pytest.approx((~came).sum(), rel=0.12)


def test_nothing_is_missing_at_an_uneven_pace_or_after_a_pause() -> None:
    inbox = Inbox()
    random = np.random.default_rng(0)
    stamp = 10**18
    for number in range(600):
        stamp += int(FRAME * random.uniform(0.75, 1.25)) + (3 * 10**9) * (number % 100 == 99)
        inbox.synchronizer.add_depth(stamp, 'depth')
    assert inbox.synchronizer.missing <= 6


def test_counters_go_on_after_a_rewind() -> None:
    inbox = Inbox()
    synchronizer = inbox.synchronizer
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for _ in range(2):
        for number in range(60):
            synchronizer.add_depth(10**18 + number * FRAME, 'depth')
            if number % 2 == 0:
                synchronizer.add_mask(10**18 + number * FRAME, 'mask')
                synchronizer.add_mask(10**18 + number * FRAME, 'mask')
    assert synchronizer.rewinds == 1
    assert len(inbox.delivered) == 60
    assert synchronizer.dropped == DropCounts(unmatched_depth=59, duplicates=60)


def test_without_masks_each_depth_image_is_complete() -> None:
    inbox = Inbox(with_masks=False)
    synchronizer, delivered = inbox.synchronizer, inbox.delivered
    synchronizer.add_depth(FRAME, 'first')
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    for number in (2, 4, 4, 3, 5):
        synchronizer.add_depth(number * FRAME, f'depth{number}')
    assert [depth for depth, _, _ in delivered] == ['first', 'depth2', 'depth4', 'depth5']
    assert {pair[1:] for pair in delivered} == {(None, 'info')}
    assert synchronizer.dropped == DropCounts(duplicates=1, late=1)
    assert (synchronizer.pairs, synchronizer.out_of_order) == (4, 1)
    synchronizer.add_depth(FRAME + 10**9, 'later')
    synchronizer.add_depth(FRAME, 'again')
    assert synchronizer.rewinds == 1
    assert delivered[-1][0] == 'again'


def test_slop_can_be_changed_while_it_runs() -> None:
    inbox = Inbox()
    synchronizer = inbox.synchronizer
    synchronizer.add_camera_info(OTHER_STAMP, 'info')
    synchronizer.add_depth(FRAME, 'first')
    synchronizer.add_mask(FRAME + 5, 'mask')
    assert inbox.delivered == []
    synchronizer.slop_ns = 10
    synchronizer.add_depth(2 * FRAME, 'second')
    synchronizer.add_mask(2 * FRAME + 5, 'mask')
    assert [pair[0] for pair in inbox.delivered] == ['first', 'second']
    synchronizer.add_depth(10**10, 'much later')
    synchronizer.add_depth(100, 'after a rewind')
    synchronizer.add_mask(95, 'mask')
    assert inbox.delivered[-1][0] == 'after a rewind'


def test_image_waits_for_the_camera_info_of_its_own_stamp() -> None:
    """A camera whose infos come one image late, and change from image to image."""
    inbox = Inbox(with_masks=False)
    for number in range(10):
        inbox.synchronizer.add_depth(number * FRAME, f'depth{number}')
        if number:
            inbox.synchronizer.add_camera_info((number - 1) * FRAME, f'info{number - 1}')
    # The first image does not wait: only the newest one does until the first info comes.
    assert inbox.delivered == [(f'depth{n}', None, f'info{n}') for n in range(1, 9)]


def test_late_mask_gets_the_camera_info_of_its_image() -> None:
    inbox = Inbox()
    for number in range(10):
        inbox.synchronizer.add_depth(number * FRAME, f'depth{number}')
        inbox.synchronizer.add_camera_info(number * FRAME, f'info{number}')
        if number >= 3:
            inbox.synchronizer.add_mask((number - 3) * FRAME, f'mask{number - 3}')
    assert inbox.delivered == [(f'depth{n}', f'mask{n}', f'info{n}') for n in range(7)]


def test_lost_camera_info_is_replaced_by_the_one_before() -> None:
    inbox = Inbox(with_masks=False)
    for number in range(8):
        inbox.synchronizer.add_depth(number * FRAME, f'depth{number}')
        if number != 4:
            inbox.synchronizer.add_camera_info(number * FRAME, f'info{number}')
    infos = [3 if number == 4 else number for number in range(8)]
    assert inbox.delivered == [(f'depth{n}', None, f'info{i}') for n, i in enumerate(infos)]


def test_images_wait_no_longer_if_the_camera_infos_stop() -> None:
    inbox = Inbox(with_masks=False, capacity=30)
    for number in range(20):
        inbox.synchronizer.add_depth(number * FRAME, f'depth{number}')
        if number < 5:
            inbox.synchronizer.add_camera_info(number * FRAME, f'info{number}')
        assert len(inbox.delivered) >= number - 2
    assert inbox.delivered[-1] == ('depth19', None, 'info4')
    assert len(inbox.delivered) == 20


def test_first_image_after_a_jump_has_the_camera_info_that_came_before_it() -> None:
    inbox = Inbox()
    for number in (*range(100, 103), 1):
        inbox.synchronizer.add_camera_info(number * FRAME, f'info{number}')
        inbox.synchronizer.add_depth(number * FRAME, f'depth{number}')
        inbox.synchronizer.add_mask(number * FRAME, f'mask{number}')
    assert inbox.synchronizer.rewinds == 1
    assert inbox.delivered[-1] == ('depth1', 'mask1', 'info1')
