"""How fast a model is: every stage timed on the same frames, beside the plain kernels."""

import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame
from lsc_pose_ros.evaluation.stage_times import (
    DESCRIPTOR,
    FAST,
    PLAIN,
    STAGES,
    STAGES_WITH_PLAIN_KERNELS,
    walk,
)
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model

WHOLE = 'whole'
"""From a frame's bytes to its skeletons; what the stages add up to."""


# So many frames are done in one way, then in the other: in a stream, too, a frame finds the caches
# as the frame before has left them.
TURN = 10


class FrameTimes(NamedTuple):
    """What one frame cost, all of its bodies together.

    Attributes:
        seconds: of each stage, and of WHOLE.
        plain: the same with the plain kernels, without the stages that have none; empty where
            they were not run.
        apart: the distances between the joints found both ways, metres, shape (B, J); NaN where
            neither way found a joint, infinity where only one did.
    """

    seconds: dict[str, float]
    plain: dict[str, float]
    apart: NDArray[np.float32]


class StageSummary(NamedTuple):
    """The times of one stage over all frames, milliseconds.

    Attributes:
        ms_p50: the median.
        ms_p95: 95 % of the frames took no longer.
        plain_ms_p50: the plain kernels' median; None where the stage has none of its own.
        ratio_to_plain: how many times as long the plain kernels took: the ratio of the medians.
    """

    ms_p50: float
    ms_p95: float
    plain_ms_p50: float | None
    ratio_to_plain: float | None


def warm_up(estimator: Estimator, frames: Sequence[EncodedFrame]) -> list[EncodedFrame]:
    """Compile and run all that will be timed; return the frames in which somebody is estimated.

    Raises:
        InputError: there is no such frame.
    """
    seen = [frame for frame in frames if np.isfinite(_estimate(estimator, frame).positions).any()]
    if not seen:
        msg = (
            f'nobody is seen well enough in any of {len(frames)} frames; '
            'time them on a recording with people, or at a larger size'
        )
        raise InputError(msg)
    for kernels in (FAST, PLAIN):
        walk(estimator.model, seen[0], kernels)
    return seen


def time_frames(
    estimator: Estimator, frames: Sequence[EncodedFrame], *, compare: bool = True
) -> Iterator[FrameTimes]:
    """Time one frame after the other, on one core.

    Args:
        estimator: with the graph; WHOLE is its `estimate`, with the decoding before it.
        frames: those that `warm_up` has returned.
        compare: whether the plain kernels take turns with the fast ones, a few frames each, so
            that what else the machine does slows down both.

    Yields:
        the times of each frame, turn by turn.
    """
    for start in range(0, len(frames), TURN):
        turn = frames[start : start + TURN]
        wholes = [_time_whole(estimator, frame) for frame in turn]
        stages = [walk(estimator.model, frame, FAST).seconds for frame in turn]
        plain = [_time_plain(estimator.model, frame) for frame in turn] if compare else []
        for n, (whole, positions) in enumerate(wholes):
            seconds = stages[n] | {WHOLE: whole}
            if plain:
                yield FrameTimes(seconds, plain[n][0], _apart(positions, plain[n][1]))
            else:
                yield FrameTimes(seconds, {}, _apart(positions, positions))


def _time_whole(estimator: Estimator, frame: EncodedFrame) -> tuple[float, NDArray[np.float32]]:
    begin = time.perf_counter()
    skeletons = _estimate(estimator, frame)
    return time.perf_counter() - begin, skeletons.positions


def _time_plain(model: Model, frame: EncodedFrame) -> tuple[dict[str, float], NDArray[np.float32]]:
    walked = walk(model, frame, PLAIN)
    seconds = walked.seconds | {WHOLE: sum(walked.seconds.values())}
    if model.settings.feature != '3dlsc':
        del seconds[DESCRIPTOR]
    return seconds, walked.positions


def summarise_times(times: Sequence[FrameTimes]) -> dict[str, StageSummary]:
    """Return the summary of each stage, in their order, and of WHOLE."""
    summaries = {}
    for stage in (*STAGES, WHOLE):
        seconds = np.array([frame.seconds[stage] for frame in times])
        middle, most = 1000 * np.percentile(seconds, (50, 95))
        plain = None
        compared = all(stage in frame.plain for frame in times)
        if compared and stage in (*STAGES_WITH_PLAIN_KERNELS, WHOLE):
            plain = 1000 * float(np.median([frame.plain[stage] for frame in times]))
        summaries[stage] = StageSummary(
            float(middle), float(most), plain, None if plain is None else plain / float(middle)
        )
    return summaries


def _estimate(estimator: Estimator, frame: EncodedFrame) -> Skeletons:
    depth, labels = decode_frame(frame)
    return estimator.estimate(depth, labels, frame.camera)


def _apart(first: NDArray[np.float32], second: NDArray[np.float32]) -> NDArray[np.float32]:
    apart: NDArray[np.float32] = np.linalg.norm(first - second, axis=-1).astype(np.float32)
    only_one = np.isnan(first[..., 0]) != np.isnan(second[..., 0])
    return np.where(only_one, np.float32(np.inf), apart)
