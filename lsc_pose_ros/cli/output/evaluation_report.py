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

import numpy as np

from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.viz.drawing.canvas import save_png
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame
from lsc_pose_ros.viz.report.ranking import rank_frames
from lsc_pose_ros.viz.report.report import Report, write_report
from lsc_pose_ros.viz.report.time_plot import joint_over_time

FRAMES_SHOWN = 8


def report_evaluation(
    directory: Path,
    estimator: Estimator,
    readers: Sequence[FrameReader],
    results: tuple[Evaluation, Summary, float],
    facts: dict[str, str],
) -> Path:
    """Write the page into `directory` and return its path.

    Args:
        directory: the folder of the page; it is created if it does not exist.
        estimator: the estimator that was evaluated.
        readers: the recordings, in the order of the evaluation.
        results: the evaluation, its summary, and the tolerance in metres.
        facts: more lines of the page, by name.

    Raises:
        InputError: the page cannot be written.
    """
    evaluation, summary, tolerance = results
    ranking = rank_frames(evaluation, FRAMES_SHOWN)
    # Frames are read again because a recording can be larger than the memory.
    drawn = _draw(estimator, readers, {*ranking.best, *ranking.worst})
    report = Report(
        f'How good {facts["model"]} is',
        summary,
        evaluation,
        tolerance,
        facts,
        [drawn[number] for number in ranking.best],
        [drawn[number] for number in ranking.worst],
    )
    return write_report(directory, report)


def draw_video(directory: Path, ways: dict[str, list[VideoFrame]], summary: Summary) -> Path:
    """Draw the joint with the largest error over time beside the page; return the picture's path.

    Args:
        directory: the folder of the page.
        ways: the frames of a video, by the name of the estimation.
        summary: the scores of the joints.

    Raises:
        InputError: the picture cannot be written.
    """
    joint = max(summary.joints, key=lambda name: np.nan_to_num(summary.joints[name].mean_error_m))
    path = directory / 'video.png'
    save_png(joint_over_time(ways, joint), path)
    return path


def _draw(
    estimator: Estimator, readers: Sequence[FrameReader], wanted: set[int]
) -> dict[int, DrawnFrame]:
    return {
        number: _drawn(estimator, number, frame)
        for number, frame in enumerate(read_frames(readers, 'drawing'))
        if number in wanted
    }


def _drawn(estimator: Estimator, number: int, frame: Frame) -> DrawnFrame:
    estimate = estimator.estimate(frame.depth, frame.labels, frame.camera)
    return DrawnFrame(f'frame {number}', frame, estimate, estimator.model.settings)
