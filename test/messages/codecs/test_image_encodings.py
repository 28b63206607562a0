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

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import parse_format
from lsc_pose_ros.messages.codecs.image_encodings import (
    ImageLayout,
    decode_depth,
    decode_mask,
    view_pixels,
)


def as_image(pixels, encoding, *, big_endian=False, padding=0):
    """Return the bytes and the layout of an image message that shows `pixels`."""
    stored = pixels.astype(pixels.dtype.newbyteorder('>' if big_endian else '<'))
    rows = [row.tobytes() + b'\xaa' * padding for row in stored]
    layout = ImageLayout(encoding, *pixels.shape, len(rows[0]), big_endian)
    return b''.join(rows), layout


@pytest.mark.parametrize('big_endian', [False, True])
@pytest.mark.parametrize('padding', [0, 1, 4])
@pytest.mark.parametrize('encoding', ['16UC1', 'mono16'])
def test_millimetres_become_metres(encoding, padding, big_endian):
    pixels = np.random.default_rng(0).integers(0, 65536, (5, 7)).astype(np.uint16)
    depth = decode_depth(*as_image(pixels, encoding, big_endian=big_endian, padding=padding))
    assert depth.dtype == np.float32
    np.testing.assert_allclose(depth, pixels / 1000, rtol=1e-6)


@pytest.mark.parametrize('big_endian', [False, True])
def test_metres_stay_and_what_is_invalid_becomes_zero(big_endian):
    pixels = np.array([[1.5, np.nan, np.inf], [-np.inf, -1.0, 0.0]], np.float32)
    depth = decode_depth(*as_image(pixels, '32FC1', big_endian=big_endian))
    np.testing.assert_array_equal(depth, np.array([[1.5, 0, 0], [0, 0, 0]], np.float32))


@pytest.mark.parametrize(
    ('encoding', 'kind'),
    [('mono8', 'u1'), ('8UC1', 'u1'), ('16UC1', 'u2'), ('mono16', 'u2'), ('32SC1', 'i4')],
)
@pytest.mark.parametrize('background', [0, 255])
def test_mask_gives_body_numbers(encoding, kind, background):
    pixels = np.array([[0, 1, 7], [255, 255, 0]], kind)
    labels = decode_mask(*as_image(pixels, encoding, padding=3), background)
    expected = np.where(pixels == background, NO_BODY, pixels.astype(np.int64))
    np.testing.assert_array_equal(labels, expected)
    assert labels.dtype == np.int32


@pytest.mark.parametrize(
    ('decode', 'what'), [(decode_depth, 'depth image'), (decode_mask, 'mask')]
)
def test_unknown_encoding_is_named_with_those_that_are_known(decode, what):
    with pytest.raises(InputError, match=f"{what}: unknown encoding 'rgb8'; .*16UC1"):
        decode(b'\0' * 12, ImageLayout('rgb8', 2, 2, 6, big_endian=False))


@pytest.mark.parametrize(
    'layout',
    [
        ImageLayout('16UC1', 0, 2, 4, big_endian=False),
        ImageLayout('16UC1', 2, 0, 4, big_endian=False),
        ImageLayout('16UC1', 2, 2, 3, big_endian=False),
        ImageLayout('16UC1', 3, 2, 4, big_endian=False),
    ],
)
def test_bytes_that_do_not_fill_the_image_are_refused(layout):
    with pytest.raises(InputError, match='8 bytes do not fill'):
        decode_depth(b'\0' * 8, layout)


def test_decoding_does_not_write_to_the_message():
    data = np.array([[0, 1500]], np.uint16).tobytes()
    decode_depth(data, ImageLayout('16UC1', 1, 2, 4, big_endian=False))[0, 0] = 9
    assert data == np.array([[0, 1500]], np.uint16).tobytes()


def test_long_names_from_messages_are_cut():
    with pytest.raises(InputError, match='unknown encoding') as error:
        view_pixels(b'', ImageLayout('x' * 190_000, 1, 1, 1, big_endian=False), {}, 'mask')
    assert len(str(error.value)) < 300
    with pytest.raises(InputError, match='unknown depth format') as error:
        parse_format('x' * 190_000)
    assert len(str(error.value)) < 300
