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

"""Masks that show no people, or more than there can be."""

import numpy as np
import pytest
from fault_stream import FaultStream, camera_info, image
from waiting import wait_until

from lsc_pose_ros.data_types.frame import NO_BODY


def test_one_body_that_fills_the_image(stream: FaultStream) -> None:
    labels = np.ones_like(stream.frame.labels)
    for depth in (stream.frame.depth, np.full_like(stream.frame.depth, 1.5)):
        assert stream.ask(stream.good(depth=depth, labels=labels)).bodies.tolist() == [1]


def test_bodies_of_three_pixels_have_no_joints(stream: FaultStream) -> None:
    labels = np.full_like(stream.frame.labels, NO_BODY)
    for number in range(5):
        labels[10 * number, 20:23] = number + 1
    found = stream.ask(stream.good(depth=np.full_like(stream.frame.depth, 2.0), labels=labels))
    assert found.bodies.tolist() == [1, 2, 3, 4, 5]
    assert np.isnan(found.positions).all()


def test_of_300_bodies_the_largest_are_estimated_and_the_others_counted(
    stream: FaultStream,
) -> None:
    stream.ask(stream.good())
    before = int(stream.diagnosed('bodies beyond maximum'))
    labels = np.full((240, 320), NO_BODY, np.int32)
    for number in range(300):
        row, column = divmod(number, 20)
        labels[16 * row : 16 * row + 12, 16 * column : 16 * column + 8] = number + 1
    labels[13:16, : 16 * 7 : 16] = np.arange(1, 8)  # these are larger
    depth = np.full(labels.shape, 2.0, np.float32)
    assert not stream.services.set('maximum_bodies', 7)
    assert stream.ask(stream.good(depth=depth, labels=labels)).bodies.tolist() == [*range(1, 8)]
    assert stream.program.prints('a frame shows 293 bodies more than the 7')
    assert wait_until(lambda: int(stream.diagnosed('bodies beyond maximum')) == before + 293)
    assert not stream.services.set('maximum_bodies', 20)
    assert len(stream.ask(stream.good(depth=depth, labels=labels)).bodies) == 20
    assert stream.program.output.count('bodies more than') == 1


@pytest.mark.parametrize('kinds', [2, 300, 5000, 65535])
def test_masks_of_noise(stream: FaultStream, kinds: int) -> None:
    stream.ask(stream.good())  # thousands of bodies may each be the one that is known now
    random = np.random.default_rng(kinds)
    labels = random.integers(1, kinds, stream.frame.labels.shape, endpoint=True).astype(np.int32)
    labels[random.random(labels.shape) < 0.3] = NO_BODY
    found = stream.ask(stream.good(labels=labels))
    assert len(found.bodies) == min(kinds, 20)


def test_numbers_that_are_no_bodies_are_refused(stream: FaultStream) -> None:
    stream.reactivate()
    frame = stream.frame
    for value in (-2, 65536, 2**31 - 1, -(2**31)):
        header = stream.next_header()
        labels = np.where(frame.labels == NO_BODY, 0, value).astype('<i4')
        stream.publish(
            image(header, '32FC1', frame.depth.astype('<f4')),
            image(header, '32SC1', labels),
            camera_info(header, frame.camera, frame.depth.shape),
        )
        stream.taken()
    stream.recovers()
    assert len(stream.answered) == 1
    assert stream.program.output.count('the mask holds the body number') == 1
