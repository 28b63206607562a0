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

"""compressedDepth: 12 bytes, then PNG or RVL; 32FC1 as inverse depth."""

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngImageFile

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import (
    decode_compressed_depth,
    encode_compressed_depth,
    parse_format,
)
from lsc_pose_ros.messages.codecs.png import read_png, write_png


def millimetres():
    pixels = np.random.default_rng(1).integers(500, 4000, (24, 31), dtype=np.uint16)
    pixels[3:9, 4:20] = 0
    pixels[0, 0] = 65535
    return pixels


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_millimetres_are_kept_exactly(codec):
    text, data = encode_compressed_depth(millimetres(), codec)
    assert text == f'16UC1; compressedDepth {codec}'
    decoded = decode_compressed_depth(data, text)
    assert decoded.dtype == np.uint16
    assert np.array_equal(decoded, millimetres())


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_metres_are_kept_to_the_quantisation(codec):
    metres = (millimetres() * 1e-3).astype(np.float32)
    metres[1, :3] = np.nan, np.inf, 12.0  # nothing, nothing, beyond the largest depth
    text, data = encode_compressed_depth(metres, codec)
    decoded = decode_compressed_depth(data, text)
    assert decoded.dtype == np.float32
    known = np.isfinite(metres) & (metres > 0) & (metres < 10)
    assert np.isnan(decoded[~known]).all()
    # A step of the inverse depth is z^2 / a metres, a = 100 * 101; it is cut off, not rounded.
    step = metres[known] ** 2 / 10100
    assert (np.abs(decoded[known] - metres[known]) <= 1.01 * step).all()


def test_inverse_depth_formula():
    header = struct.pack('<iff', 1, 10100.0, -1009.0)
    quantised = np.array([[0, 1011, 4041]], np.uint16)
    decoded = decode_compressed_depth(header + write_png(quantised), '32FC1; compressedDepth png')
    assert np.isnan(decoded[0, 0])
    assert decoded[0, 1:] == pytest.approx([10100 / (1011 + 1009), 10100 / (4041 + 1009)])


@pytest.mark.parametrize(
    ('text', 'parsed'),
    [
        ('16UC1; compressedDepth', ('16UC1', 'png')),
        ('16UC1', ('16UC1', 'png')),
        ('32FC1; compressedDepth rvl', ('32FC1', 'rvl')),
        ('16UC1;compressedDepth png ', ('16UC1', 'png')),
    ],
)
def test_formats(text, parsed):
    assert parse_format(text) == parsed


@pytest.mark.parametrize(
    'text', ['', 'jpeg', '8UC1; compressedDepth png', '16UC1; jpeg compressed']
)
def test_unknown_formats(text):
    with pytest.raises(InputError, match='unknown depth format'):
        parse_format(text)


def test_unknown_codec():
    with pytest.raises(InputError, match="unknown codec 'jxl'"):
        parse_format('16UC1; compressedDepth jxl')


def test_damaged_images():
    text, data = encode_compressed_depth(millimetres(), 'png')
    for wrong in (b'', data[:12], data[:40], data[:12] + b'x' * 99):
        with pytest.raises(InputError):
            decode_compressed_depth(wrong, text)
    text, data = encode_compressed_depth(millimetres(), 'rvl')
    huge = data[:12] + struct.pack('<II', 1 << 31, 1 << 31) + data[20:]
    for wrong in (data[:12], data[:19], data[:60], huge):
        with pytest.raises(InputError):
            decode_compressed_depth(wrong, text)


def test_8_bit_image_holds_no_depth():
    data = bytes(12) + write_png(np.ones((3, 3), np.uint8))
    with pytest.raises(InputError, match='8 bits'):
        decode_compressed_depth(data, '16UC1; compressedDepth png')


def test_random_damage_never_does_worse_than_an_input_error():
    random = np.random.default_rng(2)
    for codec in ('png', 'rvl'):
        text, data = encode_compressed_depth(millimetres(), codec)
        for _ in range(150):
            damaged = bytearray(data)
            for place in random.integers(0, len(data), 3):
                damaged[place] ^= 1 << int(random.integers(8))
            try:
                decode_compressed_depth(bytes(damaged), text)
            except InputError:
                continue


@pytest.mark.parametrize('kind', [np.uint8, np.uint16])
def test_png_keeps_the_pixels(kind):
    pixels = np.random.default_rng(0).integers(0, np.iinfo(kind).max, (7, 5)).astype(kind)
    read = read_png(write_png(pixels))
    assert read.dtype == kind
    assert np.array_equal(read, pixels)


def test_png_with_colours_is_refused():
    stream = io.BytesIO()
    Image.new('RGB', (4, 4)).save(stream, 'PNG')
    with pytest.raises(InputError, match='mode RGB'):
        read_png(stream.getvalue())


@pytest.mark.filterwarnings('ignore::PIL.Image.DecompressionBombWarning')
@pytest.mark.parametrize('size', [(10**4, 10**4), (2**31 - 1, 1), (10**9, 10**9)])
def test_png_that_claims_more_pixels_than_any_camera_has_is_not_loaded(size, monkeypatch):
    header = struct.pack('>IIBBBBB', *size, 16, 0, 0, 0, 0)
    chunks = ((b'IHDR', header), (b'IDAT', zlib.compress(bytes(100))), (b'IEND', b''))
    data = b'\x89PNG\r\n\x1a\n' + b''.join(
        struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
        for kind, body in chunks
    )
    loaded = []
    monkeypatch.setattr(PngImageFile, 'load', lambda _: loaded.append(1))
    with pytest.raises(InputError, match=r'pixels|DecompressionBomb'):
        read_png(data)
    assert not loaded
