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

"""The transport `compressedDepth` of image_transport: a 12-byte header, then PNG or RVL.

16UC1 is stored unchanged. 32FC1 is stored as quantised inverse depth q, where
depth = a / (q - b) and q = 0 means no depth; the header holds a and b.
"""

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.png import read_png, write_png
from lsc_pose_ros.messages.codecs.rvl import decode_rvl, encode_rvl

_HEADER = struct.Struct('<iff')
_RVL_SIZE = struct.Struct('<II')
_INVERSE_DEPTH = 1
_MOST_PIXELS = 1 << 26

# mono16 is what drivers write that convert to and from OpenCV; the pixels are those of 16UC1.
_ENCODINGS = ('16UC1', 'mono16', '32FC1')

# The transport's own defaults for 32FC1.
DEPTH_MAX = 10.0
DEPTH_QUANTIZATION = 100.0


class CompressedFormat(NamedTuple):
    """The parts of the field `format` of a compressedDepth message."""

    encoding: str
    codec: str


def parse_format(text: str) -> CompressedFormat:
    """Return the encoding and the codec that a CompressedImage's field `format` names.

    Args:
        text: for example '16UC1; compressedDepth png'; old publishers name no codec, it is png.

    Raises:
        InputError: `text` is not a format of compressedDepth.
    """
    encoding, _, transport = (part.strip() for part in text.partition(';'))
    words = transport.split() or ['compressedDepth']
    codec = words[1] if len(words) > 1 else 'png'
    if encoding not in _ENCODINGS or words[0] != 'compressedDepth':
        msg = (
            f'unknown depth format {text!r:.60}; it must be {" or ".join(_ENCODINGS)} by '
            'compressedDepth'
        )
        raise InputError(msg)
    if codec not in {'png', 'rvl'}:
        msg = (
            f'unknown codec {codec!r:.60} in the depth format {text!r:.60}; it must be png or rvl'
        )
        raise InputError(msg)
    return CompressedFormat(encoding, codec)


def decode_compressed_depth(
    data: bytes | memoryview, format_text: str
) -> NDArray[np.uint16] | NDArray[np.float32]:
    """Return the depth image of a compressedDepth message, shape (H, W).

    Args:
        data: the message's data: the header and the compressed image.
        format_text: the message's field `format`.

    Returns:
        uint16 millimetres for 16UC1 and mono16, float32 metres (NaN for no depth) for 32FC1.

    Raises:
        InputError: the format is unknown or the data are damaged.
    """
    encoding, codec = parse_format(format_text)
    if len(data) <= _HEADER.size:
        msg = f'a compressedDepth image of {len(data)} bytes has no pixels'
        raise InputError(msg)
    _, scale, offset = _HEADER.unpack_from(data)
    body = memoryview(data)[_HEADER.size :]
    pixels = read_png(body) if codec == 'png' else _read_rvl(body)
    if pixels.dtype != np.uint16:
        msg = 'a compressedDepth image of 8 bits holds no depth; 16 are needed'
        raise InputError(msg)
    if encoding != '32FC1':
        return pixels.astype(np.uint16)
    return _from_inverse(pixels.astype(np.uint16), scale, offset)


def encode_compressed_depth(
    pixels: NDArray[np.uint16] | NDArray[np.float32], codec: str = 'png'
) -> tuple[str, bytes]:
    """Return `pixels` as the fields `format` and `data` of a compressedDepth message.

    Args:
        pixels: uint16 millimetres or float32 metres, shape (H, W).
        codec: 'png' or 'rvl'.
    """
    scale = offset = 0.0
    encoding = '16UC1'
    if pixels.dtype == np.float32:
        encoding = '32FC1'
        scale = DEPTH_QUANTIZATION * (DEPTH_QUANTIZATION + 1)
        offset = 1 - scale / DEPTH_MAX
        pixels = _to_inverse(pixels.astype(np.float32), scale, offset)
    whole = pixels.astype(np.uint16)
    body = write_png(whole) if codec == 'png' else _write_rvl(whole)
    header = _HEADER.pack(_INVERSE_DEPTH, scale, offset)
    return f'{encoding}; compressedDepth {codec}', header + body


def _from_inverse(
    quantised: NDArray[np.uint16], scale: float, offset: float
) -> NDArray[np.float32]:
    depth = np.full(quantised.shape, np.nan, np.float32)
    known = quantised > 0
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        depth[known] = np.float32(scale) / (quantised[known] - np.float32(offset))
    return depth


def _to_inverse(depth: NDArray[np.float32], scale: float, offset: float) -> NDArray[np.uint16]:
    with np.errstate(invalid='ignore'):
        known = (depth > 0) & (depth < DEPTH_MAX)
    quantised = np.zeros(depth.shape, np.uint16)
    quantised[known] = np.clip(scale / depth[known] + offset, 0, np.iinfo(np.uint16).max)
    return quantised


def _read_rvl(body: memoryview) -> NDArray[np.uint16]:
    width, height = _RVL_SIZE.unpack_from(body) if len(body) >= _RVL_SIZE.size else (0, 0)
    if not 0 < width * height <= _MOST_PIXELS:
        msg = f'the RVL image is damaged: it claims to be {width} x {height} pixels'
        raise InputError(msg)
    return decode_rvl(body[_RVL_SIZE.size :], width * height).reshape(height, width)


def _write_rvl(pixels: NDArray[np.uint16]) -> bytes:
    height, width = pixels.shape
    return _RVL_SIZE.pack(width, height) + encode_rvl(pixels)
