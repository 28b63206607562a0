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

"""Decodes the bytes of uncompressed images into metres and body numbers.

Depth follows REP-118: the encoding alone determines the meaning of a pixel.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.conversion import (
    labels_from_mask,
    metres_from_millimetres,
    without_invalid,
)
from lsc_pose_ros.errors import InputError

DEPTH_TYPES: dict[str, np.dtype[np.generic]] = {
    '16UC1': np.dtype('u2'),
    'mono16': np.dtype('u2'),  # the name of 16UC1 in some drivers
    '32FC1': np.dtype('f4'),
}
MASK_TYPES: dict[str, np.dtype[np.generic]] = {
    'mono8': np.dtype('u1'),
    '8UC1': np.dtype('u1'),
    '8SC1': np.dtype('i1'),
    '16UC1': np.dtype('u2'),
    'mono16': np.dtype('u2'),
    '16SC1': np.dtype('i2'),
    '32SC1': np.dtype('i4'),
}


class ImageLayout(NamedTuple):
    """The memory layout of a sensor_msgs/Image: the fields of the message."""

    encoding: str
    height: int
    width: int
    step: int
    big_endian: bool


def decode_depth(data: NDArray[np.uint8] | bytes, layout: ImageLayout) -> NDArray[np.float32]:
    """Return a depth image in metres, shape (H, W), 0 for pixels without depth.

    Args:
        data: the bytes of the image; they are not copied before the conversion.
        layout: the layout of the image.

    Raises:
        InputError: the encoding is not one of REP-118, or the bytes do not fill the image.
    """
    pixels = view_pixels(data, layout, DEPTH_TYPES, 'depth image')
    return depth_to_metres(pixels)


def depth_to_metres(pixels: NDArray[np.generic]) -> NDArray[np.float32]:
    """Return pixels in millimetres (integers) or metres (floats), shape (H, W), as valid metres.

    0, NaN, infinity and negative values mean no depth and become 0.
    """
    if pixels.dtype.kind == 'u':
        return metres_from_millimetres(pixels)
    return without_invalid(pixels.astype(np.float32))


def decode_mask(
    data: NDArray[np.uint8] | bytes, layout: ImageLayout, background: int = 0
) -> NDArray[np.int32]:
    """Return the number of the body that each pixel shows, shape (H, W), NO_BODY for none.

    Args:
        data: the image's bytes.
        layout: the message's fields.
        background: the pixel value for no body (255 in the body index map of Azure Kinect).

    Raises:
        InputError: the encoding is unknown, the bytes do not fill the image, or a body number
            does not fit UINT16.
    """
    pixels = view_pixels(data, layout, MASK_TYPES, 'mask')
    return labels_from_mask(pixels, background)


def view_pixels(
    data: NDArray[np.uint8] | bytes,
    layout: ImageLayout,
    types: dict[str, np.dtype[np.generic]],
    what: str,
) -> NDArray[np.generic]:
    """Return the pixels that `data` holds, shape (H, W), without copying them.

    Args:
        data: the image's bytes.
        layout: the message's fields.
        types: the known encodings, with the type of a pixel.
        what: the kind of image, for error messages.

    Raises:
        InputError: the encoding is unknown or the bytes do not fill the image.
    """
    if layout.encoding not in types:
        known = ', '.join(types)
        msg = f'{what}: unknown encoding {layout.encoding!r:.60}; it must be one of {known}'
        raise InputError(msg)
    pixel = types[layout.encoding].newbyteorder('>' if layout.big_endian else '<')
    values = np.frombuffer(data, np.uint8)
    height, width, step = layout.height, layout.width, layout.step
    if height < 1 or width < 1 or step < width * pixel.itemsize or len(values) < height * step:
        msg = (
            f'{what}: {len(values)} bytes do not fill {width} x {height} pixels of '
            f'{layout.encoding} at {step} bytes a row; the publisher sends a broken image'
        )
        raise InputError(msg)
    rows = values[: height * step].reshape(height, step)[:, : width * pixel.itemsize]
    if step % pixel.itemsize:
        rows = np.ascontiguousarray(rows)
    return rows.view(pixel)
