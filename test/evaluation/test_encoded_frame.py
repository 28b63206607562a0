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

"""Encoded frames: the encodings, and what decoding returns."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.evaluation.encoded_frame import decode_frame, encode_frame


@pytest.mark.parametrize(
    ('numbers', 'encoding', 'background'),
    [
        ((1, 2), 'mono8', 0),
        ((255,), 'mono8', 0),
        ((0, 7), 'mono8', 255),
        ((0, 255), '16UC1', 65535),
        ((300, 65535), '16UC1', 0),
        ((0, 65535), '32SC1', -1),
    ],
)
def test_mask_is_encoded_in_the_fewest_bytes_that_keep_it(numbers, encoding, background):
    rng = np.random.default_rng(0)
    labels = rng.choice([NO_BODY, *numbers], (6, 9))
    labels[0, : len(numbers)] = numbers
    frame = frame_of(np.ones(labels.shape), labels)
    encoded = encode_frame(frame)
    assert (encoded.mask_layout.encoding, encoded.background) == (encoding, background)
    np.testing.assert_array_equal(decode_frame(encoded)[1], labels)


def test_depth_in_whole_millimetres_is_16uc1_and_any_other_is_32fc1():
    rng = np.random.default_rng(1)
    whole = rng.integers(0, 5000, (5, 7))
    labels = np.zeros((5, 7))
    in_millimetres = encode_frame(frame_of(whole / 1000, labels))
    assert in_millimetres.depth_layout.encoding == '16UC1'
    np.testing.assert_array_equal(in_millimetres.depth.view('<u2').reshape(5, 7), whole)
    np.testing.assert_allclose(decode_frame(in_millimetres)[0], whole / 1000, atol=1e-6)
    assert in_millimetres.size == '7x5'
    for depth in (rng.random((5, 7)), np.full((5, 7), 66.0)):
        encoded = encode_frame(frame_of(depth, labels))
        assert encoded.depth_layout.encoding == '32FC1'
        np.testing.assert_array_equal(decode_frame(encoded)[0], depth.astype(np.float32))


def frame_of(depth: np.ndarray, labels: np.ndarray) -> Frame:
    camera = Intrinsics(60.0, 60.0, 10.0, 10.0)
    return Frame(0, 'camera', depth.astype(np.float32), labels.astype(np.int32), camera, None)
