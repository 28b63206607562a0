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

"""Depth images, masks, camera infos and ground truth of a recording are joined."""

import numpy as np

from lsc_pose_ros.data_types.skeletons import no_skeletons
from lsc_pose_ros.synchronization.synchronizer import Synchronizer, SynchronizerSettings

GROUND_TRUTH = no_skeletons(np.arange(3, dtype=np.uint16))


def synchronizer_with(*, with_mask, with_ground_truth, capacity=30):
    return Synchronizer(
        SynchronizerSettings(
            capacity=capacity,
            waiting=capacity,
            with_masks=with_mask,
            with_ground_truth=with_ground_truth,
        )
    )


def add_info(synchronizer, stamp, focal=100.0):
    return synchronizer.add_camera_info(stamp, focal)


def focals(frames):
    return [(frame.stamp, frame.camera_info) for frame in frames]


def test_everything_of_one_stamp_in_any_order():
    for order in ('dmct', 'tcmd', 'mtdc', 'ctdm'):
        synchronizer = synchronizer_with(with_mask=True, with_ground_truth=True)
        add = {
            'd': lambda a: a.add_depth(7, 'depth'),
            'm': lambda a: a.add_mask(7, 'mask'),
            'c': lambda a: add_info(a, 7),
            't': lambda a: a.add_ground_truth(7, GROUND_TRUTH),
        }
        found = [frame for kind in order for frame in add[kind](synchronizer)]
        (frame,) = found
        assert (frame.stamp, frame.depth, frame.mask, frame.ground_truth) == (
            7,
            'depth',
            'mask',
            GROUND_TRUTH,
        )


def test_each_frame_has_the_camera_of_its_own_stamp():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=False)
    frames = []
    for stamp in range(5):
        frames += synchronizer.add_depth(stamp, 'd')
        frames += add_info(synchronizer, stamp, 100.0 + stamp)
    assert focals(frames + synchronizer.finish()) == [(stamp, 100.0 + stamp) for stamp in range(5)]


def test_camera_that_comes_once_serves_all():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=False, capacity=3)
    add_info(synchronizer, 0)
    frames = [frame for stamp in range(1, 11) for frame in synchronizer.add_depth(stamp, 'd')]
    assert [frame.stamp for frame in frames] == list(range(1, 8))
    frames += synchronizer.finish()
    assert focals(frames) == [(stamp, 100.0) for stamp in range(1, 11)]


def test_camera_that_comes_late_serves_those_that_wait():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=False, capacity=3)
    frames = [frame for stamp in range(5) for frame in synchronizer.add_depth(stamp, 'd')]
    assert frames == []
    assert synchronizer.without_camera_info == 2
    assert focals(add_info(synchronizer, 50)) == [(2, 100.0), (3, 100.0), (4, 100.0)]


def test_older_camera_does_not_settle_a_newer_frame():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=False)
    synchronizer.add_depth(10, 'd')
    assert add_info(synchronizer, 5, 100.0) == []
    assert focals(add_info(synchronizer, 10, 200.0)) == [(10, 200.0)]


def test_between_two_cameras_the_earlier_holds():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=False)
    add_info(synchronizer, 0, 100.0)
    synchronizer.add_depth(5, 'd')
    assert focals(add_info(synchronizer, 10, 200.0)) == [(5, 100.0)]
    synchronizer.add_depth(15, 'd')
    assert focals(synchronizer.finish()) == [(15, 200.0)]


def test_ground_truth_may_be_missing():
    synchronizer = synchronizer_with(with_mask=False, with_ground_truth=True)
    frames = []
    for stamp in range(6):
        frames += add_info(synchronizer, stamp)
        frames += synchronizer.add_depth(stamp, 'd')
        if stamp % 2:
            frames += synchronizer.add_ground_truth(stamp, GROUND_TRUTH)
    assert [frame.stamp for frame in frames] == list(range(6))
    assert [frame.ground_truth is GROUND_TRUTH for frame in frames] == [False, True] * 3


def test_frames_keep_the_order_of_the_depth_images_when_stamps_go_back():
    """A recording that was made of a replay in a loop."""
    synchronizer = synchronizer_with(with_mask=True, with_ground_truth=True, capacity=4)
    stamps, frames = [10, 20, 30, 11, 21, 31], []
    for stamp in stamps:
        frames += synchronizer.add_depth(stamp, 'd')
        frames += synchronizer.add_mask(stamp, 'm')
        frames += add_info(synchronizer, stamp)
        frames += synchronizer.add_ground_truth(stamp, GROUND_TRUTH)
    frames += synchronizer.finish()
    assert [frame.stamp for frame in frames] == stamps
    assert all(frame.ground_truth is GROUND_TRUTH for frame in frames)


def test_nothing_waits_without_bound():
    synchronizer = synchronizer_with(with_mask=True, with_ground_truth=True, capacity=5)
    for stamp in range(1000):
        synchronizer.add_depth(stamp, 'd')
        synchronizer.add_mask(stamp + (stamp % 3 == 0), 'm')
        synchronizer.add_ground_truth(stamp, GROUND_TRUTH)
        add_info(synchronizer, stamp)
    assert len(synchronizer._waiting) <= 5
    assert len(synchronizer._camera_infos) <= 10
    assert len(synchronizer._ground_truths) <= 10
    assert synchronizer._pairing.waiting_depth <= 100


def live_synchronizer(*, with_masks, slop_ns=0):
    settings = SynchronizerSettings(with_masks=with_masks, live=True, slop_ns=slop_ns)
    synchronizer = Synchronizer(settings)
    for stamp in range(1, 30):
        add_info(synchronizer, stamp)
    return synchronizer


def answers(frames):
    return [(frame.stamp, frame.mask) for frame in frames]


def test_images_that_wait_for_masks_are_used_without_if_there_are_no_more_masks():
    synchronizer = live_synchronizer(with_masks=True)
    synchronizer.add_depth(1, 'depth')
    assert answers(synchronizer.add_mask(1, 'mask')) == [(1, 'mask')]
    assert not synchronizer.add_depth(3, 'depth')
    assert not synchronizer.add_depth(2, 'depth')
    assert not synchronizer.add_mask(4, 'mask')
    assert answers(synchronizer.use_masks(with_masks=False)) == [(2, None), (3, None)]
    assert answers(synchronizer.add_depth(4, 'depth')) == [(4, None)]
    assert not synchronizer.add_depth(3, 'depth')
    assert not synchronizer.add_depth(1, 'depth')
    assert synchronizer.pairs == 4
    assert synchronizer.dropped.unmatched_masks == 1
    assert synchronizer.dropped.unmatched_depth == 0
    assert synchronizer.dropped.late == 2


def test_no_image_is_used_twice_when_masks_begin():
    synchronizer = live_synchronizer(with_masks=False)
    assert answers(synchronizer.add_depth(5, 'depth')) == [(5, None)]
    assert not synchronizer.use_masks(with_masks=True)
    assert not synchronizer.use_masks(with_masks=True)
    assert not synchronizer.add_depth(5, 'depth')
    assert not synchronizer.add_depth(4, 'depth')
    assert not synchronizer.add_mask(5, 'mask')
    assert not synchronizer.add_depth(6, 'depth')
    assert answers(synchronizer.add_mask(6, 'mask')) == [(6, 'mask')]
    assert synchronizer.dropped.duplicates == 1
    assert synchronizer.dropped.late == 1


def test_images_that_wait_within_the_slop_are_paired_no_more():
    synchronizer = live_synchronizer(with_masks=True, slop_ns=3)
    synchronizer.add_depth(10, 'depth')
    assert answers(synchronizer.add_mask(10, 'mask')) == [(10, 'mask')]
    synchronizer.add_depth(20, 'depth')
    synchronizer.add_mask(21, 'mask')
    assert answers(synchronizer.use_masks(with_masks=False)) == [(20, None)]
