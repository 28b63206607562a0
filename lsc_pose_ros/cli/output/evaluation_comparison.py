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

"""Formats the results of several models side by side."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

_NARROWEST = 16


def different_names(models: Sequence[Path]) -> list[str]:
    """Return the shortest ends of the models' paths that differ, without their suffix."""
    paths = [model.with_suffix('') for model in models]
    longest = max(len(path.parts) for path in paths)
    for length in range(1, longest + 1):
        names = ['/'.join(path.parts[-length:]) for path in paths]
        if len(set(names)) == len(names):
            return names
    return [f'{number} {path.name}' for number, path in enumerate(paths, start=1)]


def comparison_table(names: Sequence[str], results: Sequence[dict[str, Any]]) -> str:
    """Return a table with a row for each joint and two columns for each model.

    Args:
        names: of the models.
        results: of each model, from `evaluation_results`.
    """
    within = f'in {100 * results[0]["tolerance_m"]:g} cm'
    width = max(_NARROWEST, *(len(name) + 2 for name in names))
    joints = list(dict.fromkeys(joint for each in results for joint in each['joints']))
    lines = [f'{"":<12}' + ''.join(f'{name:>{width}}' for name in names)]
    lines.append(f'{"joint":<12}' + f'{"cm  " + within:>{width}}' * len(names))
    for joint in joints:
        cells = [_cells(each['joints'].get(joint), width) for each in results]
        lines.append(f'{joint:<12}' + ''.join(cells))
    means = [_numbers(each['mean_error_m'], each['map'], width) for each in results]
    lines.append(f'{"mean":<12}' + ''.join(means))
    if all('with_offsets' in each for each in results):
        moved = [each['with_offsets'] for each in results]
        cells = [_numbers(each['mean_error_m'], each['map'], width) for each in moved]
        lines.append(f'{"with offsets":<12}' + ''.join(cells))
    times = [f'{each["ms_per_frame"]["p50"]:.1f} ms' for each in results]
    lines.append(f'{"a frame":<12}' + ''.join(f'{time:>{width}}' for time in times))
    lines.append(f'{results[0]["frames"]} frames, {results[0]["people"]} people')
    return '\n'.join(lines)


def _cells(score: dict[str, Any] | None, width: int) -> str:
    return (
        f'{"-":>{width}}' if score is None else _numbers(score['mean_error_m'], score['ap'], width)
    )


def _numbers(error: float, fraction: float, width: int) -> str:
    return f'{f"{100 * error:.1f}{100 * fraction:8.1f} %":>{width}}'
