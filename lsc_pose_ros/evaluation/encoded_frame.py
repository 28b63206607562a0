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

"""Frames encoded like image messages, so that the benchmark can time the decoding, too."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.messages.codecs.image_encodings import (
    DEPTH_TYPES,
    MASK_TYPES,
    ImageLayout,
    decode_depth,
    decode_mask,
)

# The largest distance of a depth to the next whole millimetre that counts as rounding, metres.
_ROUNDING = 1e-6


class EncodedFrame(NamedTuple):
    """The bytes of a depth image and of its mask.

    Attributes:
        depth: the depth image's bytes.
        depth_layout: their layout.
        mask: the mask's bytes.
        mask_layout: their layout.
        background: the value of mask pixels without a body.
        camera: the intrinsics.
    """

    depth: NDArray[np.uint8]
    depth_layout: ImageLayout
    mask: NDArray[np.uint8]
    mask_layout: ImageLayout
    background: int
    camera: Intrinsics

    @property
    def size(self) -> str:
        """The image's size as the command line writes it, e.g. 320x240."""
        return f'{self.depth_layout.width}x{self.depth_layout.height}'


def encode_frame(frame: Frame) -> EncodedFrame:
    """Return `frame` in the smallest lossless encodings, like those of a camera."""
    millimetres = np.rint(frame.depth.astype(np.float64) * 1000)
    whole = np.abs(millimetres / 1000 - frame.depth).max() < _ROUNDING
    depth_encoding = '16UC1' if whole and millimetres.max() <= 65535 else '32FC1'
    depth = millimetres if depth_encoding == '16UC1' else frame.depth
    mask_encoding, background = _mask_encoding(frame.labels)
    mask = np.where(frame.labels == NO_BODY, background, frame.labels)
    depth_pixels = depth.astype(DEPTH_TYPES[depth_encoding])
    mask_pixels = mask.astype(MASK_TYPES[mask_encoding])
    return EncodedFrame(
        np.frombuffer(depth_pixels.tobytes(), np.uint8),
        _layout(depth_encoding, depth_pixels),
        np.frombuffer(mask_pixels.tobytes(), np.uint8),
        _layout(mask_encoding, mask_pixels),
        background,
        frame.camera,
    )


def decode_frame(encoded: EncodedFrame) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return depth in metres and the body numbers, shape (H, W) each."""
    depth = decode_depth(encoded.depth, encoded.depth_layout)
    return depth, decode_mask(encoded.mask, encoded.mask_layout, encoded.background)


def _mask_encoding(labels: NDArray[np.int32]) -> tuple[str, int]:
    """Return the encoding of a mask and its background, a number that no body has."""
    numbers = set(np.unique(labels).tolist())
    for encoding, most in (('mono8', 255), ('16UC1', 65535)):
        for background in (0, most):
            if max(numbers) <= most and background not in numbers:
                return encoding, background
    return '32SC1', NO_BODY


def _layout(encoding: str, pixels: NDArray[np.generic]) -> ImageLayout:
    height, width = pixels.shape
    return ImageLayout(encoding, height, width, width * pixels.itemsize, big_endian=False)
