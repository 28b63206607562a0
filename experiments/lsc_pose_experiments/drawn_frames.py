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

"""Labelled frames drawn at random from recordings, held in little memory."""

import heapq
import zlib
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame, encode_frame

# Most of a depth image is background: the quickest compression leaves a tenth of it.
_LEVEL = 1


class DrawnFrame(NamedTuple):
    """A labelled frame and the random number that decides when its turn is.

    Attributes:
        turn: from 0 to 1; the frames with the smallest ones are taken.
        encoded: the images, their bytes compressed.
        ground_truth: the labels.
    """

    turn: float
    encoded: EncodedFrame
    ground_truth: Skeletons


class Draw(NamedTuple):
    """What is drawn from one recording.

    Attributes:
        frames: in the order of their turns.
        labelled: how many labelled frames the recording has.
    """

    frames: list[DrawnFrame]
    labelled: int


def draw_frames(frames: Iterable[Frame], wanted: int, seed: Sequence[int]) -> Draw:
    """Return `wanted` of the labelled `frames` at random, or all where there are fewer.

    Every labelled frame gets a turn, and those with the first turns are kept. So a smaller draw
    is the beginning of a larger one, and draws from several recordings, merged by their turns, are
    a draw from all of them together.

    Args:
        frames: of one recording; only as many are held as are wanted.
        wanted: how many.
        seed: of the turns.
    """
    rng = np.random.default_rng(seed)
    heap: list[tuple[float, int, DrawnFrame]] = []
    labelled = 0
    for number, frame in enumerate(frames):
        ground_truth = frame.ground_truth
        if ground_truth is None or not np.isfinite(ground_truth.positions).any():
            continue
        labelled += 1
        turn = float(rng.random())
        if len(heap) == wanted and (not heap or -turn <= heap[0][0]):
            continue
        # The heap's first entry is the one with the last turn, the next to be dropped.
        entry = -turn, number, DrawnFrame(turn, _smaller(frame), ground_truth)
        if len(heap) < wanted:
            heapq.heappush(heap, entry)
        else:
            heapq.heapreplace(heap, entry)
    return Draw([kept for _, _, kept in sorted(heap, reverse=True)], labelled)


def merge(draws: Iterable[Draw]) -> list[DrawnFrame]:
    """Return the frames of several draws in the order of their turns."""
    return list(heapq.merge(*(draw.frames for draw in draws), key=lambda frame: frame.turn))


def restore(drawn: Iterable[DrawnFrame]) -> Iterator[Frame]:
    """Yield the frames themselves; their stamps count from 0."""
    for number, (_turn, encoded, ground_truth) in enumerate(drawn):
        whole = encoded._replace(
            depth=_decompressed(encoded.depth), mask=_decompressed(encoded.mask)
        )
        yield Frame(number, 'camera', *decode_frame(whole), encoded.camera, ground_truth)


def _smaller(frame: Frame) -> EncodedFrame:
    encoded = encode_frame(frame)
    return encoded._replace(depth=_compressed(encoded.depth), mask=_compressed(encoded.mask))


def _compressed(data: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.frombuffer(zlib.compress(data.tobytes(), _LEVEL), np.uint8)


def _decompressed(data: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.frombuffer(zlib.decompress(data.tobytes()), np.uint8)
