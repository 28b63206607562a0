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

"""Plots of an evaluation: errors of each joint, cumulative errors, reliability."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.evaluation.confidence_reliability import Reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.viz.drawing.canvas import CHART_WIDTH, house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import (
    ALL_JOINTS,
    BORDER,
    FAINT,
    LEFT,
    LIMB_ENDS,
    MIDDLE,
    PAGE,
    PARTS,
    RIGHT,
    LineLook,
)
from lsc_pose_ros.viz.drawing.svg import Chart

# The end of the error axis; joints with larger errors are not found at all.
FARTHEST_CM = 30

_BAR = 0.4  # its height, in rows

_SIDES = {'l_': LEFT, 'r_': RIGHT, '': MIDDLE}
_SIDE_NAMES = {'l_': "person's left", 'r_': "person's right", '': 'middle'}


def joint_bars(summary: Summary, tolerance: float) -> tuple[Chart, Chart]:
    """Return bars of each joint's mean error and of its fraction within `tolerance` metres."""
    errors = {name: 100 * score.mean_error_m for name, score in summary.joints.items()}
    fractions = {name: 100 * score.ap for name, score in summary.joints.items()}
    within = f'within {100 * tolerance:g} cm, %'
    left = _bars(errors, 'mean error, cm', 100 * summary.mean_error_m)
    right = _bars(fractions, within, 100 * summary.map)
    right.axes[0].set_xlim(0, 118)
    right.axes[0].set_xticks(range(0, 101, 20))
    return (
        Chart(left, _bars_seen('Mean error', errors, 'cm', 100 * summary.mean_error_m)),
        Chart(
            right,
            _bars_seen(
                f'Fraction within {100 * tolerance:g} cm', fractions, '%', 100 * summary.map
            ),
        ),
    )


def side_entries(names: Iterable[str]) -> list[Line2D]:
    """Return the legend of the sides that `names` of joints have."""
    used = {_side(name) for name in names}
    return [
        Line2D([], [], color=_SIDES[side], linewidth=5, solid_capstyle='butt', label=label)
        for side, label in _SIDE_NAMES.items()
        if side in used
    ]


@house_style()
def error_curves(evaluation: Evaluation, tolerance: float) -> Chart:
    """Return the cumulative error curves of all joints, and of elbows, wrists and hands.

    A joint that was not estimated has an infinite error.
    """
    groups = _groups(evaluation)
    figure = draw_curves(
        {name: (errors, PARTS[name]) for name, errors in groups.items()}, tolerance
    )
    ends = ', '.join(
        f'{name} {_percent_within(errors, tolerance):.1f} %' for name, errors in groups.items()
    )
    seen = f'Rising curves of the joints within an error. Within {100 * tolerance:g} cm: {ends}.'
    return Chart(figure, seen)


def part_entries(evaluation: Evaluation) -> list[Line2D]:
    """Return the legend of `error_curves`."""
    return [curve_entry(PARTS[name], name) for name in _groups(evaluation)]


def curve_entry(look: LineLook, name: str) -> Line2D:
    """Return the entry of a curve in a legend."""
    return Line2D([], [], color=look.colour, dashes=look.dashes, linewidth=2, label=name)


@house_style()
def draw_curves(
    curves: Mapping[str, tuple[NDArray[np.float32], LineLook]], tolerance: float
) -> Figure:
    """Return the cumulative curves of errors, metres, by name."""
    figure = new_figure(CHART_WIDTH, 2.8)
    axes = figure.subplots()
    axes.axvline(100 * tolerance, color=BORDER, linewidth=0.9)
    axes.text(100 * tolerance, 1.5, ' tolerance', color=FAINT, fontsize=8, va='bottom')
    for number, (errors, look) in enumerate(curves.values()):
        curve = cumulative(errors)
        axes.plot(
            curve.centimetres, curve.percent, color=look.colour, dashes=look.dashes,
            linewidth=1.6 if number else 2.2,
        )  # fmt: skip
    axes.set_xlim(0, FARTHEST_CM)
    axes.set_ylim(0, 101)
    axes.set_xlabel('error, cm')
    axes.set_ylabel('joints within')
    axes.yaxis.set_major_formatter(PercentFormatter())
    return figure


@house_style()
def reliability_plot(reliability: Reliability) -> Chart:
    """Return the fraction of joints that are near over their confidence, bin by bin.

    A histogram of the confidence is below.
    """
    figure = new_figure(CHART_WIDTH, 3.6)
    fractions, counts = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    fractions.plot([0, 100], [0, 100], color=BORDER, linewidth=0.9)
    percent = np.array([(100 * each.confidence, 100 * each.fraction) for each in reliability.bins])
    fractions.plot(percent[:, 0], percent[:, 1], color=MIDDLE, marker='o', markersize=4)
    fractions.set_ylim(0, 101)
    fractions.set_ylabel(f'within {100 * reliability.within_m:g} cm')
    fractions.yaxis.set_major_formatter(PercentFormatter())
    total = sum(each.n for each in reliability.bins)
    for each in reliability.bins:
        width = 100 * (each.most - each.least)
        counts.bar(100 * each.least, 100 * each.n / total, 0.9 * width, align='edge', color=FAINT)
    counts.set_ylabel('joints')
    counts.yaxis.set_major_formatter(PercentFormatter())
    counts.set_xlim(0, 100)
    counts.set_xlabel('confidence')
    counts.xaxis.set_major_formatter(PercentFormatter())
    points = ', '.join(f'{y:.0f} % of those with {x:.0f} %' for x, y in percent)
    return Chart(
        figure, f'Joints within {100 * reliability.within_m:g} cm, by confidence: {points}.'
    )


class Curve(NamedTuple):
    """The percentage of joints with at most that error in centimetres, shape (n,) each."""

    centimetres: NDArray[np.float64]
    percent: NDArray[np.float64]


def cumulative(errors: NDArray[np.float32]) -> Curve:
    """Return the curve of `errors`, metres; NaN: no ground truth, infinity: not estimated."""
    labelled = np.sort(errors[~np.isnan(errors)])
    centimetres = np.linspace(0, FARTHEST_CM, 301)
    within = np.searchsorted(labelled, centimetres / 100, side='right')
    return Curve(centimetres, 100 * within / max(len(labelled), 1))


def _groups(evaluation: Evaluation) -> dict[str, NDArray[np.float32]]:
    """Return the errors of all joints, and those of elbows, wrists and hands if labelled."""
    names = names_of(evaluation.joints)
    groups = {ALL_JOINTS: evaluation.errors.ravel()}
    for part in LIMB_ENDS:
        mine = evaluation.errors[:, [part.removesuffix('s') in name for name in names]].ravel()
        if not np.isnan(mine).all():
            groups[part] = mine
    return groups


def _percent_within(errors: NDArray[np.float32], tolerance: float) -> float:
    labelled = errors[~np.isnan(errors)]
    return 100 * float((labelled <= tolerance).mean()) if len(labelled) else 0.0


def _side(name: str) -> str:
    return name[:2] if name[:2] in _SIDES else ''


def _bars_seen(what: str, values: Mapping[str, float], unit: str, mean: float) -> str:
    """Return the alternative text of bars: the mean, the shortest and the longest."""
    known = {name: value for name, value in values.items() if math.isfinite(value)}
    if not known:
        return f'{what} of each joint: there are no estimates.'
    least, most = min(known, key=known.__getitem__), max(known, key=known.__getitem__)
    return (
        f'{what} of each joint as bars, on average {mean:.1f} {unit}; '
        f'the shortest is {least} with {known[least]:.1f} {unit}, the longest {most} with '
        f'{known[most]:.1f} {unit}.'
    )


@house_style()
def _bars(values: Mapping[str, float], title: str, mean: float) -> Figure:
    """Return a bar for each joint; left and right of a kind are in the same row."""
    rows: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        rows.setdefault(name.removeprefix(_side(name)), {})[_side(name)] = value
    figure = new_figure(CHART_WIDTH, 0.6 + 0.36 * len(rows))
    axes = figure.subplots()
    for row, sides in enumerate(rows.values()):
        for position, (side, value) in enumerate(sides.items()):
            height = row + _BAR * (position - 0.5 * (len(sides) - 1))
            _draw_bar(axes, height, value, _SIDES[side])
    axes.axvline(mean, color=FAINT, linewidth=0.8, linestyle='--')
    axes.set_title(f'{title} (dashed: mean {mean:.1f})')
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis='y', length=0)
    axes.margins(x=0.16)
    return figure


def _draw_bar(axes: Axes, height: float, value: float, colour: str) -> None:
    length = value if math.isfinite(value) else 0.0
    axes.barh(height, length, 0.9 * _BAR, color=colour)
    axes.annotate(
        f'{value:.1f}' if math.isfinite(value) else 'no estimate',
        (length, height),
        xytext=(2, 0),
        textcoords='offset points',
        va='center',
        fontsize=8,
        # The line of the mean does not cross the number.
        bbox={'facecolor': PAGE, 'edgecolor': 'none', 'pad': 0.5},
    )
