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

"""Images of odd sizes, and images whose fields lie about their data."""

import numpy as np
import pytest
from fault_stream import FaultStream, camera_info, image, mask_of

from lsc_pose_ros.data_types.camera import Intrinsics

WRONG = 'bytes do not fill'


def test_images_without_pixels_are_refused(stream: FaultStream) -> None:
    stream.reactivate()
    for shape in ((0, 0), (0, 160), (120, 0)):
        header = stream.next_header()
        stream.publish(
            image(header, '32FC1', np.zeros(shape, '<f4')),
            image(header, '16UC1', np.zeros(shape, np.uint16)),
            camera_info(header, stream.frame.camera, shape),
        )
        stream.taken()
    assert_refused(stream)


def assert_refused(stream: FaultStream) -> None:
    """Check that no frame was answered so far, that the log says why, and only that."""
    stream.recovers()
    assert len(stream.answered) == 1
    assert WRONG in stream.program.output


@pytest.mark.parametrize('shape', [(1, 1), (1, 160), (120, 1), (2, 3)])
def test_tiny_images_are_answered(stream: FaultStream, shape: tuple[int, int]) -> None:
    depth, labels = np.full(shape, 2.0, np.float32), np.ones(shape, np.int32)
    found = stream.ask(stream.good(depth=depth, labels=labels))
    assert found.bodies.tolist() == [1]
    assert np.isnan(found.positions).all()


def test_images_of_12_megapixels_are_answered(stream: FaultStream) -> None:
    camera = stream.frame.camera
    factor = 26  # the frame of 160 x 120, enlarged and cut to 4096 x 3072
    large = Intrinsics(*(factor * each for each in camera[:4]))
    enlarged = [
        np.ascontiguousarray(each.repeat(factor, 0).repeat(factor, 1)[:3072, :4096])
        for each in (stream.frame.depth, stream.frame.labels)
    ]
    header = stream.next_header()
    stream.publish(
        image(header, '16UC1', np.rint(1000 * enlarged[0]).astype('<u2')),
        image(header, 'mono8', mask_of(enlarged[1]).astype(np.uint8)),
        camera_info(header, large, enlarged[0].shape),
    )
    assert stream.wait_for_answer(header).bodies.tolist() == [1]


LIES = {
    'too few bytes a row': {'step': 1},
    'no bytes a row': {'step': 0},
    'too many bytes a row': {'step': 160 * 4 + 1},
    'the most bytes a row': {'step': 2**32 - 1},
    'more rows': {'height': 121},
    'the most rows': {'height': 2**32 - 1},
    'the most columns': {'width': 2**32 - 1},
    'the most of all': {'height': 2**32 - 1, 'width': 2**32 - 1, 'step': 2**32 - 1},
}


@pytest.mark.parametrize('of', ['depth', 'mask'])
def test_fields_that_do_not_fit_the_data_are_refused(stream: FaultStream, of: str) -> None:
    stream.reactivate()
    frame = stream.frame
    for lie in LIES.values():
        header = stream.next_header()
        lies = [lie if name == of else {} for name in ('depth', 'mask')]
        depth = image(header, '32FC1', frame.depth.astype('<f4'), **lies[0])
        mask = image(header, '32SC1', mask_of(frame.labels).astype('<i4'), **lies[1])
        stream.publish(depth, mask, camera_info(header, frame.camera, frame.depth.shape))
        stream.taken()
    assert_refused(stream)


def test_mask_of_another_size_is_refused(stream: FaultStream) -> None:
    stream.reactivate()
    frame = stream.frame
    header = stream.next_header()
    depth = image(header, '32FC1', frame.depth.astype('<f4'))
    mask = image(header, '16UC1', mask_of(frame.labels)[:60])
    stream.publish(depth, mask, camera_info(header, frame.camera, frame.depth.shape))
    assert stream.program.prints('it is for 160 x 60 pixels')
