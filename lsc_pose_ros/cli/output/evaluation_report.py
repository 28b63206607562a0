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

"""Writes the page of `evaluate --report`, with figures of the best and the worst frames."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.cli.output.evaluation_comparison import different_names
from lsc_pose_ros.cli.output.video_results import video_rows
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.viz.drawing.svg import Chart
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame
from lsc_pose_ros.viz.report.page_parts import origin_of
from lsc_pose_ros.viz.report.ranking import rank_frames
from lsc_pose_ros.viz.report.report import Report, VideoSection, write_report
from lsc_pose_ros.viz.report.time_plot import SECONDS, joint_over_time, way_entries

FRAMES_SHOWN = 8


class EvaluatedVideo(NamedTuple):
    """The frames of a video and their scores, by the name of the estimation."""

    ways: dict[str, list[VideoFrame]]
    results: dict[str, Any]


def report_evaluation(
    directory: Path,
    estimator: Estimator,
    readers: Sequence[FrameReader],
    results: tuple[Evaluation, Summary, float],
    facts: dict[str, str],
    video: EvaluatedVideo | None = None,
) -> Path:
    """Write the page into `directory` and return its path.

    Args:
        directory: the folder of the page; it is created if it does not exist.
        estimator: the estimator that was evaluated.
        readers: the recordings, in the order of the evaluation.
        results: the evaluation, its summary, and the tolerance in metres.
        facts: more lines of the page, by name.
        video: the estimation over time, if it was measured.

    Raises:
        InputError: the page cannot be written.
    """
    evaluation, summary, tolerance = results
    ranking = rank_frames(evaluation, FRAMES_SHOWN)
    # Frames are read again because a recording can be larger than the memory.
    drawn = _draw(estimator, readers, {*ranking.best, *ranking.worst})
    report = Report(
        f'How good {facts["model"]} is',
        origin_of(__version__),
        summary,
        evaluation,
        tolerance,
        facts,
        estimator.model.provenance,
        [drawn[number] for number in ranking.best],
        [drawn[number] for number in ranking.worst],
        _video_section(video, summary, tolerance) if video else None,
    )
    return write_report(directory, report)


def farthest_joint(summary: Summary) -> str:
    """Return the joint with the largest mean error."""
    return max(summary.joints, key=lambda name: np.nan_to_num(summary.joints[name].mean_error_m))


def _video_section(video: EvaluatedVideo, summary: Summary, tolerance: float) -> VideoSection:
    joint = farthest_joint(summary)
    rows = [
        (name, [f'{number} {unit}'.rstrip() for number, unit in values])
        for name, values in video_rows(video.results, tolerance)
    ]
    ways = list(video.ways)
    errors = ' and '.join(
        f'{way} {100 * video.results[way]["mean_error_m"]:.1f} cm' for way in ways
    )
    seen = (
        f'Three curves over the first {SECONDS:g} seconds: how far {joint} is to the right, down '
        f'and away from the camera, as the ground truth and as estimated. Mean error: {errors}.'
    )
    caption = (
        f'The position of {joint}, the joint with the largest error, in the camera frame. The '
        'nearer a line is to the middle of the yellow band, the better.'
    )
    plot = Chart(joint_over_time(video.ways, joint), seen)
    return VideoSection(ways, rows, plot, way_entries(ways), caption)


def _draw(
    estimator: Estimator, readers: Sequence[FrameReader], wanted: set[int]
) -> dict[int, DrawnFrame]:
    """Return drawings by the number of the evaluation; their labels count in each recording."""
    drawn: dict[int, DrawnFrame] = {}
    number = 0
    for reader, name in zip(readers, _names(readers), strict=True):
        for own, frame in enumerate(read_frames([reader], 'drawing')):
            if number in wanted:
                drawn[number] = _drawn(estimator, f'{name}frame {own}', frame)
            number += 1
    return drawn


def _names(readers: Sequence[FrameReader]) -> list[str]:
    """Return what precedes the number of a frame: nothing if there is only one recording."""
    if len(readers) == 1:
        return ['']
    return [f'{name}, ' for name in different_names([reader.path for reader in readers])]


def _drawn(estimator: Estimator, label: str, frame: Frame) -> DrawnFrame:
    estimate = estimator.estimate(frame.depth, frame.labels, frame.camera)
    return DrawnFrame(label, frame, estimate, estimator.model.settings)
