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

"""Decodes images, compressed or not, into metres and body numbers."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.conversion import labels_from_mask
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import decode_compressed_depth
from lsc_pose_ros.messages.codecs.image_encodings import (
    decode_depth,
    decode_mask,
    depth_to_metres,
)
from lsc_pose_ros.messages.codecs.png import read_png
from lsc_pose_ros.messages.parse import StampedCompressedImage, StampedImage

AnyImage: TypeAlias = StampedImage | StampedCompressedImage


def describe_image(image: AnyImage, shape: tuple[int, ...]) -> str:
    """Return the size, the encoding and the frame of an image in words.

    Args:
        image: the message.
        shape: height and width, which the message of a compressed image does not tell.
    """
    encoding = image.layout.encoding if isinstance(image, StampedImage) else image.format
    return f'{shape[1]}x{shape[0]}, {encoding!r:.60}, frame {image.frame_id!r:.60}'


def depth_of(image: AnyImage) -> NDArray[np.float32]:
    """Return a depth image in metres, shape (H, W), 0 for pixels without depth.

    Raises:
        InputError: the encoding is unknown, or the data do not fill the image.
    """
    if isinstance(image, StampedImage):
        return decode_depth(image.data, image.layout)
    if 'compresseddepth' not in image.format.lower() and 'png' in image.format.lower():
        pixels = read_png(image.data.data)  # 16UC1 by the transport `compressed`
        if pixels.dtype != np.uint16:
            msg = f'the PNG depth image ({image.format!r:.60}) has 8 bits; depth needs 16'
            raise InputError(msg)
        return depth_to_metres(pixels)
    return depth_to_metres(decode_compressed_depth(image.data.data, image.format))


def labels_of(image: AnyImage, background: int) -> NDArray[np.int32]:
    """Return the body that each pixel of a mask shows, shape (H, W), NO_BODY for none.

    Args:
        image: the mask.
        background: the pixel value for no body.

    Raises:
        InputError: the encoding is unknown or lossy, or the data do not fill the image.
    """
    if isinstance(image, StampedImage):
        return decode_mask(image.data, image.layout, background)
    if 'png' not in image.format.lower():
        msg = (
            f'a mask compressed as {image.format!r:.60} cannot be used; only PNG keeps the numbers'
        )
        raise InputError(msg)
    return labels_from_mask(read_png(image.data.data), background)
