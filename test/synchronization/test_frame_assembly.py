"""Depth, mask, camera and truth put together."""

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import no_skeletons
from lsc_pose_ros.messages.parse import StampedCamera
from lsc_pose_ros.synchronization.frame_assembly import Assembly

TRUTH = no_skeletons(np.arange(3, dtype=np.uint16))


def info(stamp, focal=100.0):
    return StampedCamera(stamp, 4, 5, Intrinsics(focal, focal, 2, 2))


def focals(frames):
    return [(frame.stamp, frame.camera.camera.fx) for frame in frames]


def test_everything_of_one_stamp_in_any_order():
    for order in ('dmct', 'tcmd', 'mtdc', 'ctdm'):
        assembly = Assembly(with_mask=True, with_ground_truth=True)
        add = {
            'd': lambda a: a.add_depth(7, 'depth'),
            'm': lambda a: a.add_mask(7, 'mask'),
            'c': lambda a: a.add_camera(info(7)),
            't': lambda a: a.add_ground_truth(7, TRUTH),
        }
        found = [frame for kind in order for frame in add[kind](assembly)]
        (frame,) = found
        assert (frame.stamp, frame.depth, frame.mask, frame.ground_truth) == (
            7,
            'depth',
            'mask',
            TRUTH,
        )


def test_each_frame_has_the_camera_of_its_own_stamp():
    assembly = Assembly(with_mask=False, with_ground_truth=False)
    frames = []
    for stamp in range(5):
        frames += assembly.add_depth(stamp, 'd')
        frames += assembly.add_camera(info(stamp, 100.0 + stamp))
    assert focals(frames + assembly.finish()) == [(stamp, 100.0 + stamp) for stamp in range(5)]


def test_a_camera_that_comes_once_serves_all():
    assembly = Assembly(with_mask=False, with_ground_truth=False, capacity=3)
    assembly.add_camera(info(0))
    frames = [frame for stamp in range(1, 11) for frame in assembly.add_depth(stamp, 'd')]
    assert [frame.stamp for frame in frames] == list(range(1, 8))
    frames += assembly.finish()
    assert focals(frames) == [(stamp, 100.0) for stamp in range(1, 11)]


def test_a_camera_that_comes_late_serves_those_that_wait():
    assembly = Assembly(with_mask=False, with_ground_truth=False, capacity=3)
    frames = [frame for stamp in range(5) for frame in assembly.add_depth(stamp, 'd')]
    assert frames == []
    assert assembly.without_camera == 2
    assert focals(assembly.add_camera(info(50))) == [(2, 100.0), (3, 100.0), (4, 100.0)]


def test_an_older_camera_does_not_settle_a_newer_frame():
    assembly = Assembly(with_mask=False, with_ground_truth=False)
    assembly.add_depth(10, 'd')
    assert assembly.add_camera(info(5, 100.0)) == []
    assert focals(assembly.add_camera(info(10, 200.0))) == [(10, 200.0)]


def test_between_two_cameras_the_earlier_holds():
    assembly = Assembly(with_mask=False, with_ground_truth=False)
    assembly.add_camera(info(0, 100.0))
    assembly.add_depth(5, 'd')
    assert focals(assembly.add_camera(info(10, 200.0))) == [(5, 100.0)]
    assembly.add_depth(15, 'd')
    assert focals(assembly.finish()) == [(15, 200.0)]


def test_ground_truth_may_be_missing():
    assembly = Assembly(with_mask=False, with_ground_truth=True)
    frames = []
    for stamp in range(6):
        frames += assembly.add_camera(info(stamp))
        frames += assembly.add_depth(stamp, 'd')
        if stamp % 2:
            frames += assembly.add_ground_truth(stamp, TRUTH)
    assert [frame.stamp for frame in frames] == list(range(6))
    assert [frame.ground_truth is TRUTH for frame in frames] == [False, True] * 3


def test_frames_keep_the_order_of_the_depth_images_when_stamps_go_back():
    """A recording that was made of a replay in a loop."""
    assembly = Assembly(with_mask=True, with_ground_truth=True, capacity=4)
    stamps, frames = [10, 20, 30, 11, 21, 31], []
    for stamp in stamps:
        frames += assembly.add_depth(stamp, 'd')
        frames += assembly.add_mask(stamp, 'm')
        frames += assembly.add_camera(info(stamp))
        frames += assembly.add_ground_truth(stamp, TRUTH)
    frames += assembly.finish()
    assert [frame.stamp for frame in frames] == stamps
    assert all(frame.ground_truth is TRUTH for frame in frames)


def test_nothing_waits_without_bound():
    assembly = Assembly(with_mask=True, with_ground_truth=True, capacity=5)
    for stamp in range(1000):
        assembly.add_depth(stamp, 'd')
        assembly.add_mask(stamp + (stamp % 3 == 0), 'm')
        assembly.add_ground_truth(stamp, TRUTH)
        assembly.add_camera(info(stamp))
    assert len(assembly._waiting) <= 5
    assert len(assembly._cameras) <= 10
    assert len(assembly._truths) <= 10
    assert assembly.pairing.waiting_depth <= 100
