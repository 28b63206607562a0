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
"""The results of `curves.py` as a figure and as tables."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lsc_pose_ros.evaluation.benchmark import DECODE, WHOLE
from lsc_pose_ros.files.kinds import TEXT
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.pose.stages import STAGE_NAMES
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure, save_png
from lsc_pose_ros.viz.drawing.legend import add_legend_entries

_STAGES = (DECODE, *STAGE_NAMES)

# Colour-blind people can distinguish them (Okabe and Ito); neighbours also differ in lightness.
_COLOURS = dict(
    zip(
        _STAGES,
        (
            '#bdbdbd', '#8c8c8c', '#0072b2', '#56b4e9', '#f0e442', '#d55e00', '#e69f00', '#009e73',
            '#cc79a7',
        ),
        strict=True,
    )
)  # fmt: skip
_INK = '#1a1a1a'


@house_style()
def draw_curves(results: dict[str, Any], path: Path) -> None:
    """Draw the six curves of `results` and write them to `path`."""
    figure = new_figure(10.5, 6.4)
    axes = figure.subplots(2, 3).ravel()
    curves = results['curves']
    for plot, (name, title) in zip(
        axes,
        {
            'points': 'points N, all of them vote (640x480)',
            'query_points': 'query points Q of 400',
            'trees': 'trees',
            'size': 'image size (logarithmic)',
            'bodies': 'bodies in the mask (640x480)',
        }.items(),
        strict=False,
    ):
        _draw_stages(plot, curves[name], _x_positions(name, curves[name]['values']))
        plot.set_xlabel(title)
    axes[0].set_ylabel('milliseconds a frame')
    axes[3].set_ylabel('milliseconds a frame')
    _draw_training(axes[5], results['training'])
    _explain(figure)
    save_png(figure, path)


def _x_positions(name: str, values: Sequence[Any]) -> list[float]:
    if name != 'size':
        return list(values)
    widths_heights = [value.split('x') for value in values]
    return [float(width) * float(height) for width, height in widths_heights]


def _draw_stages(axes: Axes, curve: dict[str, Any], positions: list[float]) -> None:
    stages = curve['stages']
    axes.stackplot(
        positions,
        [stages[stage]['ms_p50'] for stage in _STAGES],
        colors=[_COLOURS[stage] for stage in _STAGES],
        edgecolor='white',
        linewidth=0.6,
    )
    axes.plot(
        positions, stages[WHOLE]['ms_p50'], color=_INK, marker='o', markersize=4, linewidth=1.2
    )
    axes.plot(positions, stages[WHOLE]['ms_p95'], color=_INK, linestyle=':', linewidth=1.2)
    if isinstance(curve['values'][0], str):
        axes.set_xscale('log', base=2)
        axes.minorticks_off()
    axes.set_xticks(positions, [str(value) for value in curve['values']])
    axes.set_xlim(min(positions), max(positions))
    axes.set_ylim(bottom=0)


def _draw_training(axes: Axes, training: dict[str, Any]) -> None:
    frames = training['frames']
    axes.plot(
        frames, training['processor_seconds'], color=_COLOURS['votes'], marker='^', markersize=4,
        linestyle='--', label='processor time, all cores',
    )  # fmt: skip
    axes.plot(frames, training['seconds'], color=_INK, marker='s', markersize=4, label='passed')
    axes.legend(loc='upper left')
    axes.set_xlabel(f'training frames, {training["trees"]} trees')
    axes.set_ylabel('seconds')
    axes.set_xticks(training['frames'])
    axes.tick_params(axis='x', rotation=45)
    axes.set_xlim(0, 1.03 * max(training['frames']))
    axes.set_ylim(bottom=0)


def _explain(figure: Figure) -> None:
    entries: list[Any] = [Patch(color=_COLOURS[stage], label=stage) for stage in _STAGES]
    lines = [
        Line2D([], [], color=_INK, marker='o', markersize=4, label='whole, median'),
        Line2D([], [], color=_INK, linestyle=':', label='whole, 95 % of the frames'),
    ]
    add_legend_entries(figure, [*entries, *lines], lines=2)


def write_tables(results: dict[str, Any], path: Path) -> None:
    """Replace the tables in the page at `path` by those of `results`."""
    page = path.read_text(encoding='utf-8')
    tables = '\n\n'.join(
        [
            _machine(results),
            *(_stage_table(stages) for stages in results['stages']),
            *_curve_tables(results),
        ]
    )
    pattern = r'(<!-- measured -->\n).*(<!-- end -->)'
    page = re.sub(
        pattern, lambda found: f'{found[1]}\n{tables}\n\n{found[2]}', page, flags=re.DOTALL
    )
    write_output(path, TEXT, page.encode())


def _machine(results: dict[str, Any]) -> str:
    machine = results['machine']
    used = ', '.join(f'{name} {version}' for name, version in results['versions'].items())
    architecture = machine['architecture'].replace('_', '-')
    return (
        f'Measured on {results["date"]}: {machine["cores"]} cores of an {machine["processor"]}, '
        f'{architecture}, no GPU; {used}.'
    )


def _stage_table(measured: dict[str, Any]) -> str:
    rows = [
        [
            name,
            f'{stage["ms_p50"]:.2f}',
            f'{stage["ms_p95"]:.2f}',
            _or_dash(stage['plain_ms_p50'], '{:.2f}'),
            _or_dash(stage['ratio_to_plain'], '{:.1f}'),
        ]
        for name, stage in measured['stages'].items()
    ]
    title = (
        f'**{measured["size"]}**, one body, N = {measured["points"]}, '
        f'Q = {measured["query_points"]}, {measured["trees"]} trees, '
        f'{measured["joints"]} joints, graph on: '
        f'{measured["frames_per_second"]:.0f} frames/s on one core'
    )
    head = ['stage', 'median, ms', '95 %, ms', 'plain kernels, ms', 'times as fast']
    return f'{title}\n\n{_table(head, rows)}'


def _curve_tables(results: dict[str, Any]) -> list[str]:
    titles = {
        'points': 'points N, all of them vote, 640x480',
        'query_points': 'query points Q of 400, 320x240',
        'trees': 'trees, 320x240',
        'size': 'image size',
        'bodies': 'bodies, 640x480',
    }
    tables = [
        _table(
            [title, *map(str, results['curves'][name]['values'])],
            [
                ['whole frame, ms', *_numbers(results['curves'][name]['stages'][WHOLE]['ms_p50'])],
            ],
        )
        for name, title in titles.items()
    ]
    training = results['training']
    head = [f'training frames, {training["trees"]} trees', *map(str, training['frames'])]
    rows = [
        ['seconds passed', *_numbers(training['seconds'])],
        ['processor time of all cores, s', *_numbers(training['processor_seconds'])],
    ]
    return [*tables, _table(head, rows)]


def _numbers(values: Iterable[float]) -> list[str]:
    return [f'{value:.2f}' if value < 10 else f'{value:.1f}' for value in values]


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ['---', *('---:' for _ in head[1:])], *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)


def _or_dash(value: float | None, form: str) -> str:
    return '-' if value is None else form.format(value)
