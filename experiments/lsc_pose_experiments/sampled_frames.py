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

"""Random samples of labelled frames of recordings, in compressed form."""

import heapq
import zlib
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame, encode_frame

# Most of a depth image is background, so the fastest compression leaves a tenth of it.
_LEVEL = 1


class SampledFrame(NamedTuple):
    """A labelled frame and its random rank.

    Attributes:
        rank: from 0 to 1; the frames with the lowest ranks are taken.
        encoded: the compressed images.
        ground_truth: the labels.
    """

    rank: float
    encoded: EncodedFrame
    ground_truth: Skeletons


class FrameSample(NamedTuple):
    """A random sample of the frames of one recording.

    Attributes:
        frames: ascending by rank.
        labelled: number of labelled frames of the recording.
    """

    frames: list[SampledFrame]
    labelled: int


def sample_frames(frames: Iterable[Frame], wanted: int, seed: Sequence[int]) -> FrameSample:
    """Return a random sample of the labelled `frames`.

    Each labelled frame gets a random rank, and those with the lowest ranks are kept. So a smaller
    sample is the beginning of a larger one, and samples of several recordings, merged by rank, are
    a sample of all of them.

    Args:
        frames: the frames of one recording; only `wanted` of them are in memory.
        wanted: size of the sample; all frames are kept if there are fewer.
        seed: seed of the ranks.
    """
    rng = np.random.default_rng(seed)
    heap: list[tuple[float, int, SampledFrame]] = []
    labelled = 0
    for number, frame in enumerate(frames):
        ground_truth = frame.ground_truth
        if ground_truth is None or not np.isfinite(ground_truth.positions).any():
            continue
        labelled += 1
        rank = float(rng.random())
        if len(heap) == wanted and (not heap or -rank <= heap[0][0]):
            continue
        # The first entry of the heap has the highest rank, and is dropped next.
        entry = -rank, number, SampledFrame(rank, _smaller(frame), ground_truth)
        if len(heap) < wanted:
            heapq.heappush(heap, entry)
        else:
            heapq.heapreplace(heap, entry)
    return FrameSample([kept for _, _, kept in sorted(heap, reverse=True)], labelled)


def merge(draws: Iterable[FrameSample]) -> list[SampledFrame]:
    """Return the frames of several samples, ascending by rank."""
    return list(heapq.merge(*(draw.frames for draw in draws), key=lambda frame: frame.rank))


def decode_frames(drawn: Iterable[SampledFrame]) -> Iterator[Frame]:
    """Yield the decoded frames; their stamps count from 0."""
    for number, (_rank, encoded, ground_truth) in enumerate(drawn):
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
