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

"""RVL, the run-length code for depth images (Wilson, ISS 2017, listing 1), as ROS uses it.

An image is a sequence of numbers: how many pixels are 0, how many are not, and for each of the
latter its difference from the one before, zig-zag coded. A number is cut into groups of three
bits, lowest first; a group and a flag "more follow" make a nibble, eight nibbles a 32-bit word.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.numerics.jit import kernel

# A pixel's difference takes at most 17 bits, six nibbles; each run adds two short numbers.
_WORDS_A_PIXEL = 2
_SPARE_WORDS = 4


def decode_rvl(data: bytes | memoryview, count: int) -> NDArray[np.uint16]:
    """Return the `count` pixels, shape (count,), that the RVL stream `data` holds.

    Args:
        data: the stream, without the image's size.
        count: how many pixels the image has.

    Raises:
        InputError: the stream does not hold that many pixels.
    """
    used = len(data) // 4 * 4
    words = np.frombuffer(data, '<u4', used // 4).astype(np.uint32)
    pixels = np.zeros(count, np.uint16)
    if not _decode(words, pixels):
        msg = f'the RVL image is damaged: its {len(data)} bytes do not hold {count} pixels'
        raise InputError(msg)
    return pixels


def encode_rvl(pixels: NDArray[np.uint16]) -> bytes:
    """Return `pixels`, of any shape, as an RVL stream; the inverse of `decode_rvl`."""
    flat = np.ascontiguousarray(pixels, np.uint16).reshape(-1)
    words = np.zeros(_WORDS_A_PIXEL * len(flat) + _SPARE_WORDS, np.uint32)
    used = _encode(flat, words)
    return words[:used].astype('<u4').tobytes()


@kernel
def _read_number(words: NDArray[np.uint32], position: int) -> tuple[int, int]:
    """Return the number at nibble `position` and the position after it; -1 where there is none."""
    value = 0
    shift = 0
    while position < 8 * len(words) and shift < 30:
        nibble = (int(words[position >> 3]) >> (28 - 4 * (position & 7))) & 15
        value |= (nibble & 7) << shift
        shift += 3
        position += 1
        if nibble < 8:
            return value, position
    return -1, position


@kernel
def _decode(words: NDArray[np.uint32], pixels: NDArray[np.uint16]) -> bool:
    """Fill `pixels`, which are all 0, from `words`; False where the stream ends too soon."""
    total = len(pixels)
    position = 0
    done = 0
    previous = 0
    while done < total:
        zeros, position = _read_number(words, position)
        if zeros < 0 or zeros > total - done:
            return False
        done += zeros
        if done == total:
            return True
        others, position = _read_number(words, position)
        if others < 0 or others > total - done:
            return False
        for _ in range(others):
            code, position = _read_number(words, position)
            if code < 0:
                return False
            previous = (previous + ((code >> 1) ^ -(code & 1))) & 0xFFFF
            pixels[done] = previous
            done += 1
    return True


@kernel
def _write_number(words: NDArray[np.uint32], position: int, value: int) -> int:
    """Write `value` at nibble `position` and return the position after it."""
    more = True
    while more:
        nibble = value & 7
        value >>= 3
        more = value > 0
        if more:
            nibble |= 8
        words[position >> 3] |= np.uint32(nibble << (28 - 4 * (position & 7)))
        position += 1
    return position


@kernel
def _encode(pixels: NDArray[np.uint16], words: NDArray[np.uint32]) -> int:
    """Write `pixels` into `words`, which are all 0, and return how many words were used."""
    total = len(pixels)
    position = 0
    done = 0
    previous = 0
    while done < total:
        start = done
        while done < total and pixels[done] == 0:
            done += 1
        position = _write_number(words, position, done - start)
        start = done
        while done < total and pixels[done] != 0:
            done += 1
        position = _write_number(words, position, done - start)
        for index in range(start, done):
            current = int(pixels[index])
            delta = current - previous
            position = _write_number(words, position, (delta << 1) ^ (delta >> 63))
            previous = current
    return (position + 7) >> 3
