"""Depth images, masks and camera infos find each other."""

import numpy as np
import pytest

from lsc_pose_ros.synchronization.synchronizer import (
    REWIND_NS,
    Gathering,
    LeftOut,
    PairingSettings,
)

FRAME = 33_000_000


class Inbox:
    def __init__(self, slop: int = 0, capacity: int = 5) -> None:
        self.delivered: list[tuple[str, str, str]] = []
        self.gathering: Gathering[str, str, str] = Gathering(
            PairingSettings(slop, capacity), lambda *parts: self.delivered.append(parts)
        )


@pytest.mark.parametrize('mask_first', [False, True])
def test_equal_stamps_make_a_pair_in_either_order(*, mask_first: bool) -> None:
    inbox = Inbox()
    gathering = inbox.gathering
    gathering.add_camera_info('info')
    if mask_first:
        gathering.add_mask(1, 'mask')
        gathering.add_depth(1, 'depth')
    else:
        gathering.add_depth(1, 'depth')
        gathering.add_mask(1, 'mask')
    assert inbox.delivered == [('depth', 'mask', 'info')]
    assert (gathering.depth, gathering.masks, gathering.camera_infos, gathering.pairs) == (
        1,
        1,
        1,
        1,
    )


def test_newest_camera_info_goes_with_a_pair() -> None:
    inbox = Inbox()
    for number in range(3):
        inbox.gathering.add_camera_info(f'info{number}')
        inbox.gathering.add_depth(number, f'depth{number}')
        inbox.gathering.add_mask(number, f'mask{number}')
    assert inbox.delivered[2] == ('depth2', 'mask2', 'info2')


def test_camera_info_that_comes_once_serves_all_pairs() -> None:
    inbox = Inbox()
    inbox.gathering.add_camera_info('info')
    for number in range(10):
        inbox.gathering.add_depth(number, 'depth')
        inbox.gathering.add_mask(number, 'mask')
    assert len(inbox.delivered) == 10


def test_newest_pair_waits_for_the_first_camera_info() -> None:
    inbox = Inbox()
    for number in range(3):
        inbox.gathering.add_depth(number, f'depth{number}')
        inbox.gathering.add_mask(number, f'mask{number}')
    assert inbox.delivered == []
    inbox.gathering.add_camera_info('info')
    inbox.gathering.add_camera_info('info')
    assert inbox.delivered == [('depth2', 'mask2', 'info')]


def test_slop_joins_stamps_that_differ() -> None:
    inbox = Inbox(slop=1000)
    inbox.gathering.add_camera_info('info')
    inbox.gathering.add_depth(FRAME, 'depth')
    inbox.gathering.add_mask(FRAME + 1001, 'late')
    assert inbox.delivered == []
    inbox.gathering.add_mask(FRAME + 1000, 'mask')
    assert inbox.delivered == [('depth', 'mask', 'info')]


def test_masks_later_than_the_queue_is_long_find_nothing() -> None:
    inbox = Inbox(capacity=5)
    inbox.gathering.add_camera_info('info')
    for number in range(20):
        inbox.gathering.add_depth(number, 'depth')
        if number >= 5:
            inbox.gathering.add_mask(number - 5, 'mask')
    assert inbox.delivered == []
    assert inbox.gathering.pairs == 0


def test_recording_that_is_played_again_is_answered_again() -> None:
    inbox = Inbox(capacity=100)
    inbox.gathering.add_camera_info('info')
    for _ in range(3):
        for number in range(30):
            inbox.gathering.add_depth(number * FRAME, 'depth')
            inbox.gathering.add_mask(number * FRAME, 'mask')
    assert len(inbox.delivered) == 90
    assert inbox.gathering.rewinds == 2


def test_image_that_comes_a_little_late_is_no_rewind() -> None:
    inbox = Inbox()
    inbox.gathering.add_camera_info('info')
    for stamp in (REWIND_NS, 2 * REWIND_NS, REWIND_NS + 1):
        inbox.gathering.add_depth(stamp, 'depth')
        inbox.gathering.add_mask(stamp, 'mask')
    assert inbox.gathering.rewinds == 0
    assert len(inbox.delivered) == 2


def test_pairs_are_delivered_in_order_and_late_ones_are_counted() -> None:
    inbox = Inbox()
    gathering = inbox.gathering
    gathering.add_camera_info('info')
    for number in (0, 1, 2):
        gathering.add_depth(number * FRAME, f'depth{number}')
    for number in (0, 2, 1):
        gathering.add_mask(number * FRAME, f'mask{number}')
    assert [pair[0] for pair in inbox.delivered] == ['depth0', 'depth2']
    assert gathering.out_of_order == 1
    assert gathering.left_out == LeftOut(unmatched_depth=1, late=1)


def test_duplicates_are_left_out_and_counted() -> None:
    inbox = Inbox()
    gathering = inbox.gathering
    gathering.add_camera_info('info')
    for number in range(3):
        for _ in range(2):
            gathering.add_depth(number * FRAME, 'depth')
            gathering.add_mask(number * FRAME, 'mask')
    assert len(inbox.delivered) == gathering.pairs == 3
    assert gathering.left_out == LeftOut(duplicates=6)
    assert gathering.out_of_order == 0


def test_masks_slower_than_depth_give_as_many_pairs() -> None:
    inbox = Inbox(capacity=30)
    inbox.gathering.add_camera_info('info')
    for number in range(90):
        inbox.gathering.add_depth(number * FRAME, str(number))
        if number >= 8 and number % 3 == 0:
            inbox.gathering.add_mask((number - 8) * FRAME, str(number - 8))
    assert [int(pair[0]) for pair in inbox.delivered] == list(range(1, 82, 3))
    assert all(depth == mask for depth, mask, _ in inbox.delivered)
    assert inbox.gathering.left_out == LeftOut(unmatched_depth=2 * 26 + 1)
    assert inbox.gathering.missing == 0


def test_missing_stamps_are_counted() -> None:
    inbox = Inbox()
    random = np.random.default_rng(0)
    came = random.random(600) < 0.4
    came[[0, -1]] = True
    for number in np.flatnonzero(came):
        jitter = random.integers(-FRAME // 10, FRAME // 10)
        inbox.gathering.add_depth(int(10**18 + number * FRAME + jitter), 'depth')
    assert inbox.gathering.missing == pytest.approx((~came).sum(), rel=0.12)


def test_nothing_is_missing_at_an_uneven_pace_or_after_a_pause() -> None:
    inbox = Inbox()
    random = np.random.default_rng(0)
    stamp = 10**18
    for number in range(600):
        stamp += int(FRAME * random.uniform(0.75, 1.25)) + (3 * 10**9) * (number % 100 == 99)
        inbox.gathering.add_depth(stamp, 'depth')
    assert inbox.gathering.missing <= 6


def test_counters_go_on_after_a_rewind() -> None:
    inbox = Inbox()
    gathering = inbox.gathering
    gathering.add_camera_info('info')
    for _ in range(2):
        for number in range(60):
            gathering.add_depth(10**18 + number * FRAME, 'depth')
            if number % 2 == 0:
                gathering.add_mask(10**18 + number * FRAME, 'mask')
                gathering.add_mask(10**18 + number * FRAME, 'mask')
    assert gathering.rewinds == 1
    assert len(inbox.delivered) == 60
    assert gathering.left_out == LeftOut(unmatched_depth=59, duplicates=60)


def test_without_masks_each_depth_image_is_complete() -> None:
    delivered = []
    gathering: Gathering[str, str, str] = Gathering(
        PairingSettings(0, 5, with_masks=False), lambda *parts: delivered.append(parts)
    )
    gathering.add_depth(FRAME, 'first')
    gathering.add_camera_info('info')
    for number in (2, 4, 4, 3, 5):
        gathering.add_depth(number * FRAME, f'depth{number}')
    assert [depth for depth, _, _ in delivered] == ['first', 'depth2', 'depth4', 'depth5']
    assert {pair[1:] for pair in delivered} == {(None, 'info')}
    assert gathering.left_out == LeftOut(duplicates=1, late=1)
    assert (gathering.pairs, gathering.out_of_order) == (4, 1)
    gathering.add_depth(FRAME + 10**9, 'later')
    gathering.add_depth(FRAME, 'again')
    assert gathering.rewinds == 1
    assert delivered[-1][0] == 'again'


def test_slop_can_be_changed_while_it_runs() -> None:
    inbox = Inbox()
    gathering = inbox.gathering
    gathering.add_camera_info('info')
    gathering.add_depth(FRAME, 'first')
    gathering.add_mask(FRAME + 5, 'mask')
    assert inbox.delivered == []
    gathering.slop_ns = 10
    gathering.add_depth(2 * FRAME, 'second')
    gathering.add_mask(2 * FRAME + 5, 'mask')
    assert [pair[0] for pair in inbox.delivered] == ['first', 'second']
    gathering.add_depth(10**10, 'much later')
    gathering.add_depth(100, 'after a rewind')
    gathering.add_mask(95, 'mask')
    assert inbox.delivered[-1][0] == 'after a rewind'
