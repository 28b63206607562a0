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


"""Texts of a megabyte in the fields of messages."""

from fault_stream import MEGABYTE, FaultStream, camera_info, image, mask_of


def test_encodings_of_a_megabyte_are_not_repeated(stream: FaultStream) -> None:
    frame = stream.frame
    for number in range(12):
        header = stream.next_header()
        depth = image(header, '32FC1', frame.depth.astype('<f4'))
        mask = image(header, '16UC1', mask_of(frame.labels))
        broken = mask if number % 2 else depth
        broken.encoding = MEGABYTE + str(number)
        info = camera_info(header, frame.camera, frame.depth.shape)
        if number % 3 == 0:
            info.distortion_model, info.d = MEGABYTE, [0.1] * 50
        stream.publish(depth, mask, info)
        stream.taken()
    stream.recovers()
    assert 'xxxx' in stream.program.output
    assert len(stream.program.output) < 20_000


def test_frame_ids_of_a_megabyte_are_answered_and_not_logged(stream: FaultStream) -> None:
    for number in range(4):
        stream.ask(stream.good(frame_id=f'{MEGABYTE}{number}'))
    assert len(stream.diagnosed('camera roll')) < 1000
    assert len(stream.program.output) < 20_000
