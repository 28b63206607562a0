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

# ruff: noqa: INP001 - a program, not a package
"""Times each stage of the method with the fast kernels and with the plain ones in turns.

`python benchmarks/plain_comparison.py [RECORDING] [--model MODEL]` prints the median times and
their ratios. Without RECORDING it times synthetic people. The plain kernels (`test/plain`) compute
the same, compiled by the same numba, but are written as their equations read.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.cli.output.bench_results import bench_results
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.evaluation.benchmark import WHOLE, summarise_times, time_frames, warm_up
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, encode_frame
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.resources.package_files import DEFAULT_MODEL, find_model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

sys.path.append(str(Path(__file__).resolve().parents[1] / 'test'))
from plain.stages import plain_stages, stages_with_plain_kernels

_FRAMES = 60


def main() -> int:
    """Time the frames and print the table; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('recording', nargs='?', type=Path, help='default: synthetic people')
    parser.add_argument('--model', default=DEFAULT_MODEL, help='default: %(default)s')
    arguments = parser.parse_args()
    results = compare_with_plain(
        load_model(find_model(arguments.model)), _read_frames(arguments.recording)
    )
    sys.stdout.write(comparison_table(results) + '\n')
    return 0


def compare_with_plain(model: Model, frames: Sequence[EncodedFrame]) -> dict[str, Any]:
    """Return the results of `lsc_pose bench`, and beside them those of the plain kernels.

    Fast and plain kernels take turns, a block of frames each, so other load slows down both.

    Args:
        model: the model to time.
        frames: the frames to time it on.
    """
    fast, plain = Estimator(model), Estimator(model, stages=plain_stages(model))
    valid = warm_up(fast, frames)
    warm_up(plain, valid[:1])
    turns = zip(time_frames(fast, valid), time_frames(plain, valid), strict=True)
    fast_times, plain_times = zip(*progress(turns, len(valid), 'timing'), strict=True)
    results = bench_results(model, valid, fast_times)
    plain_summaries = summarise_times(plain_times)
    compared = (*stages_with_plain_kernels(model.settings), WHOLE)
    for name, stage in results['stages'].items():
        plain_median = plain_summaries[name].ms_p50 if name in compared else None
        stage['plain_ms_p50'] = plain_median
        stage['ratio_to_plain'] = plain_median and plain_median / stage['ms_p50']
    distances = np.concatenate(
        [
            joint_distances(first.positions, second.positions).ravel()
            for first, second in zip(fast_times, plain_times, strict=True)
        ]
    )
    results['distance_to_plain_mm'] = {
        # An infinite distance cannot be interpolated.
        'p95': 1000 * float(np.nanpercentile(distances, 95, method='higher')),
        'max': 1000 * float(np.nanmax(distances)),
    }
    return results


def joint_distances(
    first: NDArray[np.float32], second: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the distances of two estimates of the same joints, metres, shape (...).

    A distance is infinite if only one estimate has the joint, NaN if none has.

    Args:
        first: metres, NaN if not estimated, shape (..., 3).
        second: likewise.
    """
    distances: NDArray[np.float32] = np.linalg.norm(first - second, axis=-1).astype(np.float32)
    only_one = np.isnan(first[..., 0]) != np.isnan(second[..., 0])
    return np.where(only_one, np.float32(np.inf), distances)


def comparison_table(results: dict[str, Any]) -> str:
    """Return the times of each stage and their ratios as a table."""
    lines = [f'{"stage":<20}{"median ms":>11}{"plain ms":>10}{"ratio":>8}']
    for name, stage in results['stages'].items():
        plain = stage['plain_ms_p50']
        compared = (
            f'{plain:>10.3f}{stage["ratio_to_plain"]:>8.1f}' if plain else f'{"-":>10}{"-":>8}'
        )
        lines.append(f'{name:<20}{stage["ms_p50"]:>11.3f}{compared}')
    distances = results['distance_to_plain_mm']
    lines.append(
        f'distance of the joints: 95 % within {distances["p95"]:.2f} mm, '
        f'all within {distances["max"]:.2f} mm'
    )
    return '\n'.join(lines)


def _read_frames(recording: Path | None) -> list[EncodedFrame]:
    if recording is None:
        people = synthetic_frames(SyntheticSettings(frames=_FRAMES, seed=2, clip_length=2))
        return [encode_frame(frame) for frame in people]
    frames = list(open_recording(recording))
    return [encode_frame(frame) for frame in frames[:: max(1, len(frames) // _FRAMES)]]


if __name__ == '__main__':
    sys.exit(main())
