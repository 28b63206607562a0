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

"""The results of `lsc_pose bench`, as JSON and as a table."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lsc_pose_ros.cli.output.machine import describe_machine, versions
from lsc_pose_ros.evaluation.benchmark import WHOLE, FrameTimes, summarise_times
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame
from lsc_pose_ros.pose.model import Model


def bench_results(
    model: Model, frames: Sequence[EncodedFrame], times: Sequence[FrameTimes]
) -> dict[str, Any]:
    """Return the content of the JSON file.

    Args:
        model: the model that was timed.
        frames: the frames that it was timed on.
        times: the times of these frames.
    """
    wholes = [frame.seconds[WHOLE] for frame in times]
    return {
        'frames': len(times),
        'size': ', '.join(sorted({frame.size for frame in frames})),
        'bodies_per_frame': float(np.mean([len(frame.positions) for frame in times])),
        'points': model.settings.points,
        'query_points': model.settings.query_points,
        'trees': len(model.forest.roots),
        'joints': len(model.joints),
        'frames_per_second': 1 / float(np.mean(wholes)),
        'stages': {name: stage._asdict() for name, stage in summarise_times(times).items()},
        'machine': describe_machine() | {'cores_used': 1},
        'versions': versions(),
    }


def bench_table(results: dict[str, Any]) -> str:
    """Return `bench_results` as a table with a line for each stage, and facts below it."""
    lines = [f'{"stage":<20}{"median ms":>11}{"95 % ms":>10}']
    for name, stage in results['stages'].items():
        lines.append(f'{name:<20}{stage["ms_p50"]:>11.3f}{stage["ms_p95"]:>10.3f}')
    return '\n'.join([*lines, *_facts(results)])


def _facts(results: dict[str, Any]) -> list[str]:
    used = ', '.join(f'{name} {version}' for name, version in results['versions'].items())
    frames = f'{results["frames"]} frames of {results["size"]}'
    points = f'{results["points"]} points, {results["query_points"]} of them vote'
    forest = f'{results["trees"]} trees, {results["joints"]} joints, graph on'
    processor = results['machine']['processor']
    return [
        f'{results["frames_per_second"]:.0f} frames/s on one core of {processor}',
        f'{frames}, bodies per frame: {results["bodies_per_frame"]:.3g}; {points}; {forest}',
        used,
    ]
