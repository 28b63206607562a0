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

"""A segmenter that ends and starts again, or is late."""

import numpy as np
from fault_stream import FaultStream, camera_info, image, mask_of
from waiting import wait_until

from lsc_pose_ros.settings.table import NodeSettings


def test_without_the_segmenter_people_are_found_and_with_it_masks_are_used_again(
    stream: FaultStream,
) -> None:
    assert stream.mask is not None
    stream.stop_segmenter()

    def is_answered_without_mask() -> bool:
        stream.send(stream.good(), masked=False)
        return 'because there is no mask' in stream.program.output

    assert wait_until(is_answered_without_mask), stream.program.output
    stream.restart_segmenter()
    stream.connect()

    def uses_masks() -> bool:
        stream.send(stream.good())
        return 'bodies are the masks of /mask' in stream.program.output

    assert wait_until(uses_masks), stream.program.output


def test_segmenter_that_stops_to_send_is_told(stream: FaultStream) -> None:
    """Its publisher is there, so that its masks may still come."""
    stream.reactivate()

    def is_told() -> bool:
        stream.send(stream.good(), masked=False)
        return 'nothing received on /mask' in stream.program.output

    assert wait_until(is_told), stream.program.output
    stream.recovers()
    assert stream.program.prints('messages arrive on /mask after')


def test_masks_that_come_late_find_their_image(stream: FaultStream) -> None:
    frame = stream.frame
    headers = [stream.next_header() for _ in range(5)]
    for header in headers:
        depth = image(header, '32FC1', frame.depth.astype('<f4'))
        stream.publish(depth, None, camera_info(header, frame.camera, frame.depth.shape))
        stream.taken()
    assert not stream.answered
    for header in headers:
        assert stream.mask is not None
        stream.mask.publish(image(header, '16UC1', mask_of(frame.labels)))
        found = stream.wait_for_answer(header)
        assert np.isfinite(found.positions).any()


def test_masks_of_images_that_never_come_do_no_harm(stream: FaultStream) -> None:
    """The oldest masks are dropped and counted, so that memory is bounded."""
    assert stream.mask is not None
    stream.reactivate()
    for _ in range(100):
        header = stream.next_header()
        stream.mask.publish(image(header, '16UC1', mask_of(stream.frame.labels)))
        stream.taken()
    waiting = int(stream.diagnosed('masks')) - int(stream.diagnosed('unmatched masks'))
    assert 0 < waiting <= NodeSettings().sync_queue
