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

"""PNG images from strangers: what is read, and what a header may not claim."""

import struct
import tracemalloc
import zlib

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.png import read_png, write_png


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))


def png_that_claims(width: int, height: int, bits: int = 16, colour: int = 0) -> bytes:
    header = struct.pack('>IIBBBBB', width, height, bits, colour, 0, 0, 0)
    rows = zlib.compress(bytes(100))
    return (
        b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', rows) + chunk(b'IEND', b'')
    )


@pytest.mark.parametrize('kind', [np.uint8, np.uint16])
@pytest.mark.parametrize('shape', [(1, 1), (3, 5), (2000, 3000)])
def test_pixels_are_read_back(shape, kind):
    for pixels in (np.zeros(shape, kind), np.arange(np.prod(shape)).reshape(shape).astype(kind)):
        np.testing.assert_array_equal(read_png(write_png(pixels)), pixels)


@pytest.mark.filterwarnings('ignore::PIL.Image.DecompressionBombWarning')
@pytest.mark.parametrize('size', [(10**9, 10**9), (10_000, 10_000), (400, 400)])
def test_header_that_claims_too_much_allocates_nothing(size):
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match='no readable PNG'):
            read_png(png_that_claims(*size))
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()


def test_colours_are_refused_before_they_are_read():
    with pytest.raises(InputError, match='has the mode RGB'):
        read_png(png_that_claims(3, 3, 8, 2))


@pytest.mark.parametrize('data', [b'', b'nonsense', write_png(np.zeros((9, 9), np.uint16))[:-30]])
def test_message_is_the_same_each_time_and_short(data):
    texts = set()
    for _ in range(3):
        with pytest.raises(InputError) as error:
            read_png(bytes(data))
        texts.add(str(error.value))
    (text,) = texts
    assert '0x' not in text
    assert len(text) < 200
