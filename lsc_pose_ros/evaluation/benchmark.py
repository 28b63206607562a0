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

"""Times the estimation of frames: the whole frame, and each stage of the method."""

import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.stage_clock import StageClock
from lsc_pose_ros.pose.stages import STAGE_NAMES

DECODE = 'decode'
"""From the bytes of depth image and mask to arrays; it comes before the stages of the method."""

WHOLE = 'whole'
"""From a frame's bytes to its skeletons, timed without an observer."""

TIMED = (DECODE, *STAGE_NAMES, WHOLE)
"""The names of all times of a frame in their order."""

# This many frames are timed as a whole, then the same frames stage by stage. Within such a block a
# frame finds the caches as the frame before has left them, like in a stream.
BLOCK = 10


class FrameTimes(NamedTuple):
    """The times of one frame, all of its bodies together.

    Attributes:
        seconds: the seconds of each name in TIMED.
        positions: the estimated joints, metres, NaN if not estimated, shape (B, J, 3).
    """

    seconds: dict[str, float]
    positions: NDArray[np.float32]


class StageSummary(NamedTuple):
    """The times of one stage over all frames, milliseconds.

    Attributes:
        ms_p50: the median.
        ms_p95: 95 % of the frames took at most this long.
    """

    ms_p50: float
    ms_p95: float


def warm_up(estimator: Estimator, frames: Sequence[EncodedFrame]) -> list[EncodedFrame]:
    """Compile all kernels that are timed; return the frames in which a body is estimated.

    Raises:
        InputError: there is no such frame.
    """
    valid = [frame for frame in frames if np.isfinite(_estimate(estimator, frame).positions).any()]
    if not valid:
        msg = (
            f'too little of a person is visible in each of {len(frames)} frames; '
            'use a recording with people, or a larger size'
        )
        raise InputError(msg)
    return valid


def time_frames(estimator: Estimator, frames: Sequence[EncodedFrame]) -> Iterator[FrameTimes]:
    """Time one frame after the other, on one core.

    A block of frames is timed before its first one is yielded. To compare estimators, `zip` their
    iterators: they take turns block by block, so other load on the machine slows down all alike.

    Args:
        estimator: runs all stages of the method.
        frames: those that `warm_up` has returned.

    Yields:
        the times of each frame.
    """
    for start in range(0, len(frames), BLOCK):
        block = frames[start : start + BLOCK]
        wholes = [_time_whole(estimator, frame) for frame in block]
        stages = [time_stages(estimator, frame) for frame in block]
        for (whole, positions), seconds in zip(wholes, stages, strict=True):
            yield FrameTimes(seconds | {WHOLE: whole}, positions)


def time_stages(estimator: Estimator, frame: EncodedFrame) -> dict[str, float]:
    """Return the seconds of decoding and of each stage for one frame, all bodies together."""
    clock = StageClock((DECODE, *STAGE_NAMES))
    depth, labels = decode_frame(frame)
    clock(DECODE)
    estimator.estimate(depth, labels, frame.camera, clock)
    return clock.seconds


def summarise_times(times: Sequence[FrameTimes]) -> dict[str, StageSummary]:
    """Return the summary of each name in TIMED."""
    summaries = {}
    for stage in TIMED:
        seconds = np.array([frame.seconds[stage] for frame in times])
        median, most = 1000 * np.percentile(seconds, (50, 95))
        summaries[stage] = StageSummary(float(median), float(most))
    return summaries


def _time_whole(estimator: Estimator, frame: EncodedFrame) -> tuple[float, NDArray[np.float32]]:
    begin = time.perf_counter()
    skeletons = _estimate(estimator, frame)
    return time.perf_counter() - begin, skeletons.positions


def _estimate(estimator: Estimator, frame: EncodedFrame) -> Skeletons:
    depth, labels = decode_frame(frame)
    return estimator.estimate(depth, labels, frame.camera)
