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


"""How steady the joints of a video are, frame by frame and over time, as data and as a table."""

from collections.abc import Sequence
from typing import Any

from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.image_arguments import check_images
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.evaluation.video_scores import VideoFrame, score_video
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.settings.table import TRACKED, TemporalSettings
from lsc_pose_ros.tracking.surfaces import surfaces_of

SINGLY, OVER_TIME = 'frame by frame', 'over time'
"""The ways of estimating a video."""


class SingleFrames:
    """Keeps the estimates of single frames, with the numbers of tracked bodies.

    Attributes:
        frames: those with ground truth.
    """

    def __init__(self, estimator: Estimator) -> None:
        """Start without frames."""
        self.frames: list[VideoFrame] = []
        self._sequence = _sequence(estimator, temporal=False)

    def add(self, frame: Frame, skeletons: Skeletons) -> None:
        """Keep the estimate of the next frame."""
        if frame.ground_truth is None:
            return
        surfaces = surfaces_of(check_images(frame.depth, frame.labels, frame.camera))
        tracked = self._sequence.follow(frame.stamp, skeletons, surfaces)
        self.frames.append(VideoFrame(frame.stamp, tracked, frame.ground_truth))


def estimate_over_time(estimator: Estimator, readers: Sequence[FrameReader]) -> list[VideoFrame]:
    """Return the labelled frames of recordings, estimated over time.

    Bodies are tracked, and none is left out for its confidence or stature.

    Args:
        estimator: the estimator of each frame.
        readers: the recordings.
    """
    sequence = _sequence(estimator, temporal=True)
    return [
        VideoFrame(
            frame.stamp,
            sequence.estimate(frame.stamp, frame.depth, frame.labels, frame.camera),
            frame.ground_truth,
        )
        for frame in read_frames(readers, 'video over time')
        if frame.ground_truth is not None
    ]


def _sequence(estimator: Estimator, *, temporal: bool) -> TemporalEstimator:
    settings = TemporalSettings(
        body_ids=TRACKED, minimum_body_confidence=0.0, minimum_stature=0.0, temporal=temporal
    )
    return TemporalEstimator(estimator, settings)


def video_results(ways: dict[str, list[VideoFrame]], tolerance: float) -> dict[str, Any]:
    """Return the scores of a video by way of the estimation, for --json.

    Args:
        ways: the frames.
        tolerance: how far a joint may be off to count as found, metres.
    """
    return {name: score_video(frames, tolerance)._asdict() for name, frames in ways.items()}


def video_table(results: dict[str, Any], tolerance: float) -> str:
    """Return a table of the scores of `video_results`."""
    lines = [f'{"video":<28}' + ''.join(f'{name:>16}' for name in results)]
    for name, values in video_rows(results, tolerance):
        cells = ''.join(f'{number:>10} {unit:<5}' for number, unit in values)
        lines.append(f'{name:<28}{cells}'.rstrip())
    return '\n'.join(lines)


def video_rows(
    results: dict[str, Any], tolerance: float
) -> list[tuple[str, list[tuple[str, str]]]]:
    """Return each score of `video_results`: its name, and a number and a unit for each way."""
    rows = (
        ('mean error', 'mean_error_m', 100, 'cm'),
        (f'within {100 * tolerance:g} cm', 'map', 100, '%'),
        ('95 % of movements at rest', 'jitter_at_rest_m', 100, 'cm'),
        ("95 % of the errors' changes", 'jitter_m', 100, 'cm'),
        ('lag', 'lag_frames', 1, 'frames'),
        ('turned round', 'turned_round', 100, '%'),
        ('number changes a minute', 'id_switches_per_minute', 1, ''),
    )
    return [
        # Adding zero makes -0.0 positive.
        (name, [(f'{round(factor * way[key], 1) + 0:.1f}', unit) for way in results.values()])
        for name, key, factor, unit in rows
    ]
