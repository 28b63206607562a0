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

# Pillow's modes of images with one channel of 1, 8 or 16 bits; old versions load 16 as 32 bits.
_MODES = ('1', 'L', 'I;16', 'I;16B', 'I')

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
    from PIL import Image  # noqa: PLC0415

    try:
        with Image.open(io.BytesIO(data), formats=('PNG',)) as image:
            image.load()
            mode, pixels = image.mode, np.asarray(image)
    except (*_PILLOW_ERRORS, Image.DecompressionBombError) as error:
        msg = f'the image is no readable PNG ({error})'
        raise InputError(msg) from error
    if mode not in _MODES:
        msg = f'the PNG image has the mode {mode}, but one channel of 8 or 16 bits is needed'
        raise InputError(msg)
    if mode == 'L':
        return pixels.astype(np.uint8)
    return pixels.astype(np.uint16)


def write_png(pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Return `pixels`, shape (H, W), as a PNG image; the inverse of `read_png`."""
    from PIL import Image  # noqa: PLC0415

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, 'PNG', compress_level=1)
    return stream.getvalue()
