"""Depth images, masks and camera infos find each other."""

import pytest

from lsc_pose_ros.ros.gathering import REWIND_NS, Gathering, PairingSettings

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
    inbox.gathering.add_mask(2 * REWIND_NS, 'mask')
    for stamp in (REWIND_NS, 2 * REWIND_NS, REWIND_NS + 1):
        inbox.gathering.add_depth(stamp, 'depth')
    inbox.gathering.add_mask(REWIND_NS, 'mask')
    assert inbox.gathering.rewinds == 0
    assert len(inbox.delivered) == 2
