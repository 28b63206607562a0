"""Depth and mask joined by stamp."""

import numpy as np

from lsc_pose_ros.data.pairing import Pairing


def test_equal_stamps_pair_whichever_comes_first():
    pairing = Pairing()
    assert pairing.add_depth(1, 'd1') == []
    assert pairing.add_mask(1, 'm1') == [(1, 'd1', 'm1')]
    assert pairing.add_mask(2, 'm2') == []
    assert pairing.add_depth(2, 'd2') == [(2, 'd2', 'm2')]
    assert (pairing.waiting_depth, pairing.waiting_mask) == (0, 0)


def test_without_slop_a_nanosecond_is_too_much():
    pairing = Pairing()
    pairing.add_depth(10, 'd')
    assert pairing.add_mask(11, 'm') == []


def test_with_slop_the_nearest_is_taken_and_the_stamp_is_the_depths():
    pairing = Pairing(slop_ns=5)
    for stamp in (0, 100, 200):
        pairing.add_depth(stamp, f'd{stamp}')
    assert pairing.add_mask(104, 'm') == [(100, 'd100', 'm')]
    assert pairing.add_mask(206, 'm') == []
    assert pairing.add_depth(202, 'late') == [(202, 'late', 'm')]


def test_the_oldest_are_dropped_and_counted():
    pairing = Pairing(capacity=3)
    for stamp in range(5):
        pairing.add_depth(stamp, stamp)
        pairing.add_mask(100 + stamp, stamp)
    assert (pairing.dropped_depth, pairing.dropped_mask) == (2, 2)
    assert pairing.add_mask(1, 'm') == []
    assert pairing.add_mask(2, 'm') == [(2, 2, 'm')]


def test_repeated_stamps_are_counted_and_left_out():
    pairing = Pairing()
    pairing.add_depth(1, 'first')
    pairing.add_depth(1, 'again')
    assert pairing.add_mask(1, 'm') == [(1, 'first', 'm')]
    assert pairing.add_depth(1, 'and again') == []
    assert pairing.add_mask(1, 'm') == []
    assert pairing.duplicates == 3
    assert (pairing.waiting_depth, pairing.waiting_mask) == (0, 0)


def test_finish_counts_what_waits():
    pairing = Pairing()
    pairing.add_depth(1, 'd')
    pairing.add_mask(2, 'm')
    pairing.finish()
    assert (pairing.dropped_depth, pairing.dropped_mask) == (1, 1)


def test_any_order_within_the_capacity_finds_all_pairs():
    random = np.random.default_rng(0)
    for _ in range(20):
        stamps = range(40)
        arrivals = [
            (stamp + random.uniform(0, 8), kind, stamp) for stamp in stamps for kind in 'dm'
        ]
        pairing, found = Pairing(capacity=20), []
        for _, kind, stamp in sorted(arrivals):
            add = pairing.add_depth if kind == 'd' else pairing.add_mask
            found += add(stamp, stamp)
        assert sorted(found) == [(stamp, stamp, stamp) for stamp in stamps]
        assert pairing.duplicates == pairing.dropped_depth == pairing.dropped_mask == 0
