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

"""Stamps that do not increase as time does."""

import pytest
from builtin_interfaces.msg import Time
from fault_stream import FRAME_TIME, FaultStream, camera_info, image, mask_of
from std_msgs.msg import Header
from waiting import wait_until

from lsc_pose_ros.messages.stamps import nanoseconds

HOUR = 3600 * 10**9
YEARS = 5 * 365 * 24 * HOUR


def send_with(stream: FaultStream, stamp: Time) -> None:
    frame, header = stream.frame, Header(stamp=stamp, frame_id='camera')
    stream.publish(
        image(header, '32FC1', frame.depth.astype('<f4')),
        image(header, '16UC1', mask_of(frame.labels)),
        camera_info(header, frame.camera, frame.depth.shape),
    )
    stream.taken()


def test_after_a_jump_all_frames_are_answered(stream: FaultStream) -> None:
    stream.reactivate()
    stream.ask(stream.good())
    for jump in (-HOUR, -(10**9), HOUR, YEARS, -YEARS):
        stream.stamp += jump
        stream.recovers()
        for _ in range(3):
            stream.ask(stream.good())
    assert stream.program.prints('went back')
    assert stream.program.output.count('went back') == 1


def test_one_stamp_of_the_future_does_not_stop_the_stream(stream: FaultStream) -> None:
    before = stream.stamp
    stream.ask(stream.good(stamp=stream.stamp + 1000 * HOUR))
    stream.stamp = before
    stream.recovers()
    for _ in range(3):
        stream.ask(stream.good())


def test_stamps_that_go_back_a_little_are_left_out_until_they_are_new(
    stream: FaultStream,
) -> None:
    stream.ask(stream.good())
    newest = stream.stamp
    stream.stamp -= 6 * FRAME_TIME
    while stream.stamp < newest:
        stream.send(stream.good())
        stream.taken()
    stream.ask(stream.good())
    assert sorted(stream.answered) == stream.answered


@pytest.mark.parametrize('stamp', [Time(), Time(sec=1_900_000_000)])
def test_stamps_that_stand_still_are_told(stream: FaultStream, stamp: Time) -> None:
    stream.reactivate()

    def is_told() -> bool:
        send_with(stream, stamp)
        return 'repeat the stamp of another' in stream.program.output

    assert wait_until(is_told), stream.program.output
    assert len(stream.answered) == 1


@pytest.mark.parametrize(
    'stamp',
    [
        Time(sec=-1),
        Time(sec=-(2**31)),
        Time(sec=2**31 - 1, nanosec=2**32 - 1),
        Time(sec=5, nanosec=10**9),
    ],
)
def test_stamps_that_are_no_times_do_no_harm(stream: FaultStream, stamp: Time) -> None:
    before = stream.stamp
    send_with(stream, stamp)
    # Otherwise the stream starts over, and the first image may wait for the next camera info.
    if nanoseconds(stamp) > before:
        assert wait_until(lambda: stream.answered), stream.program.output
        assert stream.answered == [nanoseconds(stamp)]
