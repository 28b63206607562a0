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

"""Depth and mask joined by stamp."""

import numpy as np

from lsc_pose_ros.synchronization.pairing import Pairing


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


def test_equal_stamps_come_before_near_ones():
    """With a slop longer than a frame, a neighbour's mask must not be taken."""
    pairing = Pairing(slop_ns=50)
    pairing.add_depth(0, 'd0')
    assert pairing.add_mask(0, 'm0') == [(0, 'd0', 'm0')]
    assert pairing.add_depth(33, 'd33') == []
    assert pairing.add_depth(66, 'd66') == []
    assert pairing.add_mask(66, 'm66') == [(66, 'd66', 'm66')]
    assert pairing.add_mask(33, 'm33') == [(33, 'd33', 'm33')]


def test_near_stamps_pair_at_once_where_none_are_ever_equal():
    pairing = Pairing(slop_ns=10)
    for stamp in range(0, 1000, 33):
        assert pairing.add_depth(stamp, 'd') == []
        assert pairing.add_mask(stamp + 4, 'm') == [(stamp, 'd', 'm')]


def test_near_stamps_pair_once_both_streams_have_gone_past():
    pairing = Pairing(slop_ns=10)
    pairing.add_depth(0, 'd0')
    pairing.add_mask(0, 'm0')
    assert pairing.add_depth(33, 'd33') == []
    assert pairing.add_mask(37, 'm37') == []
    assert pairing.add_depth(66, 'd66') == [(33, 'd33', 'm37')]
    assert pairing.add_mask(66, 'm66') == [(66, 'd66', 'm66')]
    assert pairing.add_depth(99, 'd99') == []
    assert pairing.add_mask(95, 'm95') == []
    assert pairing.finish() == [(99, 'd99', 'm95')]


def test_slop_can_be_changed():
    pairing = Pairing()
    pairing.add_depth(10, 'd')
    assert pairing.add_mask(12, 'm') == []
    pairing.slop_ns = 5
    assert pairing.add_depth(30, 'd30') == [(10, 'd', 'm')]


def test_each_of_a_near_pair_is_the_others_nearest():
    random = np.random.default_rng(1)
    for _ in range(50):
        pairing, found = Pairing(slop_ns=40), []
        depth, mask = (2 * np.unique(random.integers(0, 500, 12)) + odd for odd in range(2))
        for stamp in depth:
            found += pairing.add_depth(int(stamp), 'd')
        assert found == []
        for stamp in mask:
            left = sorted(pairing._depth)
            pairs = pairing.add_mask(int(stamp), 'm')
            near = [each for each in left if abs(each - stamp) <= 40]
            if pairs:
                assert pairs[0][0] == min(near, key=lambda each: abs(each - stamp))
            else:
                assert not near
        assert pairing.waiting_mask <= len(mask)


def test_in_order_what_is_older_than_the_last_pair_is_late():
    pairing = Pairing(in_order=True)
    for stamp in (1, 2, 3):
        pairing.add_depth(stamp, f'd{stamp}')
    assert pairing.add_mask(2, 'm2') == [(2, 'd2', 'm2')]
    assert pairing.dropped_depth == 1  # the first waits no longer
    assert pairing.add_mask(1, 'm1') == []
    assert pairing.add_depth(1, 'again') == []
    assert pairing.late == 2
    assert pairing.add_mask(2, 'again') == []
    assert pairing.duplicates == 1
    assert pairing.add_mask(3, 'm3') == [(3, 'd3', 'm3')]
    assert (pairing.waiting_depth, pairing.waiting_mask) == (0, 0)


def test_in_order_the_stamps_of_pairs_increase_whatever_comes():
    random = np.random.default_rng(2)
    for slop in (0, 3, 30):
        pairing, stamps, came = Pairing(slop_ns=slop, capacity=8, in_order=True), [], 0
        for number in range(400):
            stamp = 10 * number + int(random.integers(-40, 40))
            add = pairing.add_depth if random.random() < 0.5 else pairing.add_mask
            stamps += [pair[0] for pair in add(stamp // 10 * 10, None)]
            came += 1
            assert max(pairing.waiting_depth, pairing.waiting_mask) <= 8
        assert stamps == sorted(set(stamps))
        left_out = pairing.dropped_depth + pairing.dropped_mask
        left_out += pairing.duplicates + pairing.late
        waiting = pairing.waiting_depth + pairing.waiting_mask
        assert 2 * len(stamps) + left_out + waiting == came


def test_oldest_are_dropped_and_counted():
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
