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

"""Reads and writes PNG images of one channel, 8 or 16 bits.

Pillow is imported at the first image: only compressed transports need it.
"""

import io
import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError

# Pillow's modes of images with one channel, and the bits of a pixel; old versions load 16 as 32.
_BITS = {'1': 1, 'L': 8, 'I;16': 16, 'I;16B': 16, 'I': 16}

# The most bytes that deflate can make from one.
_LARGEST_RATIO = 1032

# All exceptions that Pillow raises for a damaged file, with its own DecompressionBombError.
_PILLOW_ERRORS = (
    OSError,
    SyntaxError,
    ValueError,
    TypeError,
    IndexError,
    EOFError,
    MemoryError,
    OverflowError,
    struct.error,
    zlib.error,
)


def read_png(data: bytes | memoryview) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Return the pixels of the PNG image `data`, shape (H, W), uint8 or uint16.

    Raises:
        InputError: the bytes are no PNG image, or it has several channels.
    """
    from PIL import Image, UnidentifiedImageError  # noqa: PLC0415

    try:
        with Image.open(io.BytesIO(data), formats=('PNG',)) as image:
            _check_header(image.mode, image.size, len(data))
            image.load()
            pixels = np.asarray(image)
    except UnidentifiedImageError as error:  # its text has the address of an object
        msg = 'the image is no readable PNG (its beginning is not that of a PNG)'
        raise InputError(msg) from error
    except (*_PILLOW_ERRORS, Image.DecompressionBombError) as error:
        msg = f'the image is no readable PNG ({error!s:.100})'
        raise InputError(msg) from error
    if image.mode == 'L':
        return pixels.astype(np.uint8)
    return pixels.astype(np.uint16)


def _check_header(mode: str, size: tuple[int, int], available: int) -> None:
    """Check what the header of a PNG claims, before memory is allocated for its pixels.

    Raises:
        InputError: the pixels are not of one channel, or `available` bytes cannot hold them.
    """
    if mode not in _BITS:
        msg = f'the PNG image has the mode {mode}, but one channel of 8 or 16 bits is needed'
        raise InputError(msg)
    width, height = size
    if not 0 < width * height * _BITS[mode] <= 8 * _LARGEST_RATIO * available:
        msg = (
            f'the image is no readable PNG (its {available} bytes cannot hold the {width} x '
            f'{height} pixels that it claims)'
        )
        raise InputError(msg)


def write_png(pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Return `pixels`, shape (H, W), as a PNG image; the inverse of `read_png`."""
    from PIL import Image  # noqa: PLC0415

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, 'PNG', compress_level=1)
    return stream.getvalue()
