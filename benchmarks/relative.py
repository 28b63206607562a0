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

# ruff: noqa: INP001, T201 - a program, not a package
"""Segmentation and synthesis, against the estimation of one body in the same run.

`python benchmarks/relative.py` prints a table. All rows take turns frame by frame, so that what
else the machine does slows down all alike, and the ratios can be compared between machines.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import default_model
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import BACKGROUND, NEAREST, SegmentationSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

FRAMES = 60
SIZES = ((320, 240), (640, 480))

REFERENCE = 'estimation of one body, 320x240'

Task = Callable[[int], object]
"""Does the work of the frame with a number."""


def main() -> None:
    """Measure, and print the table."""
    tasks = {**_estimation(), **_segmentation(), **_synthesis()}
    times = time_in_turns(tasks)
    reference = np.median(times[REFERENCE])
    print(f'| {"task":40} | median, ms | ratio |')
    print(f'| {"-" * 40} | ---------: | ----: |')
    for name, seconds in times.items():
        median = np.median(seconds)
        print(f'| {name:40} | {1000 * median:10.2f} | {median / reference:5.2f} |')


def time_in_turns(tasks: Mapping[str, Task]) -> dict[str, list[float]]:
    """Return the seconds of each task on each frame.

    Args:
        tasks: the tasks by their names.
    """
    times: dict[str, list[float]] = {name: [] for name in tasks}
    for task in tasks.values():
        task(0)  # compiles
    for number in range(FRAMES):
        for name, task in tasks.items():
            begin = time.perf_counter()
            task(number)
            times[name].append(time.perf_counter() - begin)
    return times


def _people(width: int, height: int, **settings: Any) -> list[Frame]:  # noqa: ANN401
    asked = SyntheticSettings(
        frames=FRAMES, seed=1, clip_length=2, width=width, height=height, **settings
    )
    return list(synthetic_frames(asked))


def _estimation() -> dict[str, Task]:
    estimator = Estimator(load_model(default_model()))
    frames = _people(*SIZES[0])
    return {
        REFERENCE: lambda number: estimator.estimate(
            frames[number].depth, frames[number].labels, frames[number].camera
        )
    }


def _segmentation() -> dict[str, Task]:
    return {
        f'segmentation: {mode}, {width}x{height}': _segmenting(mode, _people(width, height))
        for mode in (NEAREST, BACKGROUND)
        for width, height in SIZES
    }


def _segmenting(mode: str, frames: list[Frame]) -> Task:
    segmenter: Any = make_segmenter(SegmentationSettings(mode, background_seconds=0.0))
    wall = np.full_like(frames[0].depth, 6.0)

    def segment_frame(number: int) -> object:
        frame = frames[number]
        return segment(segmenter, frame.stamp, frame.depth, frame.camera)

    for stamp in (0, 1):  # the background without anybody
        segment(segmenter, stamp, wall, frames[0].camera)
    return segment_frame


def _synthesis() -> dict[str, Task]:
    width, height = SIZES[0]
    frames = iter(synthetic_frames(SyntheticSettings(frames=FRAMES + 1, seed=2)))
    return {f'synthesis of one body, {width}x{height}': lambda _: next(frames)}


if __name__ == '__main__':
    main()
