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

"""The RVL kernels against a plain Python version written from the paper's listing."""

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.rvl import decode_rvl, encode_rvl


def plain_number(value):
    nibbles = []
    while True:
        more = 8 if value > 7 else 0
        nibbles.append(value % 8 + more)
        value //= 8
        if not more:
            return nibbles


def plain_encode(pixels):
    """Runs of zeros and of others, the latter as zig-zag differences; 8 nibbles a word."""
    nibbles, position, previous = [], 0, 0
    values = [int(value) for value in pixels.ravel()]
    while position < len(values):
        zeros = next((i for i, v in enumerate(values[position:]) if v), len(values) - position)
        position += zeros
        others = next(
            (i for i, v in enumerate(values[position:]) if not v), len(values) - position
        )
        nibbles += plain_number(zeros) + plain_number(others)
        for value in values[position : position + others]:
            difference = value - previous
            nibbles += plain_number(2 * difference if difference >= 0 else -2 * difference - 1)
            previous = value
        position += others
    nibbles += [0] * (-len(nibbles) % 8)
    words = [
        int(''.join(f'{n:x}' for n in nibbles[i : i + 8]), 16) for i in range(0, len(nibbles), 8)
    ]
    return np.array(words, '<u4').tobytes()


def images():
    random = np.random.default_rng(3)
    noisy = random.integers(0, 65536, (13, 17), dtype=np.uint16)
    holes = np.where(random.random((20, 31)) < 0.6, 0, random.integers(500, 4000, (20, 31)))
    return {
        'one': np.array([[7]], np.uint16),
        'one zero': np.array([[0]], np.uint16),
        'all zero': np.zeros((9, 11), np.uint16),
        'all the same': np.full((8, 8), 1234, np.uint16),
        'extremes': np.array([[0, 65535, 0, 1, 65535, 1, 0]], np.uint16),
        'noise': noisy,
        'holes': holes.astype(np.uint16),
        'zero at both ends': np.array([[0, 0, 5, 6, 0]], np.uint16),
    }


@pytest.mark.parametrize('name', images())
def test_encoding_is_the_plain_one(name):
    assert encode_rvl(images()[name]) == plain_encode(images()[name])


@pytest.mark.parametrize('name', images())
def test_decoding_gives_the_pixels_back(name):
    pixels = images()[name]
    assert np.array_equal(decode_rvl(plain_encode(pixels), pixels.size), pixels.ravel())


def test_known_stream():
    # 2 zeros, then 1 other, 5: zig-zag 10 = nibbles a 1; then 1 zero, 0 others.
    stream = np.array([0x21A11000], '<u4').tobytes()
    assert decode_rvl(stream, 4).tolist() == [0, 0, 5, 0]


def test_stream_that_ends_too_soon():
    pixels = images()['noise']
    stream = encode_rvl(pixels)
    with pytest.raises(InputError, match='do not hold 221 pixels'):
        decode_rvl(stream[: len(stream) // 2], pixels.size)
    with pytest.raises(InputError, match='do not hold'):
        decode_rvl(b'', 4)


def test_stream_for_more_pixels_than_there_are():
    with pytest.raises(InputError, match='damaged'):
        decode_rvl(encode_rvl(np.zeros(100, np.uint16)), 50)


def test_random_bytes_never_do_worse_than_an_input_error():
    random = np.random.default_rng(5)
    outcomes = set()
    for _ in range(300):
        data = random.bytes(int(random.integers(0, 64)))
        try:
            decode_rvl(data, 40)
            outcomes.add('pixels')
        except InputError:
            outcomes.add('error')
    assert outcomes == {'pixels', 'error'}
