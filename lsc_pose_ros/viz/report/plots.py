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
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.evaluation.confidence_reliability import Reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, JointScore, Summary
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER, CURVES, FAINT, LEFT, MIDDLE, RIGHT
from lsc_pose_ros.viz.drawing.legend import add_legend_entries

# The end of the error axis; joints with larger errors are not found at all.
FARTHEST_CM = 30

_BAR = 0.4  # its height, in rows

_SIDES = {'l_': LEFT, 'r_': RIGHT, '': MIDDLE}
_LIMB_ENDS = ('elbow', 'wrist', 'hand')
_DASHES: tuple[tuple[float, ...], ...] = ((), (), (5, 1.5), (2, 1.2), (6, 1.5, 1.5, 1.5))


@house_style()
def joint_bars(summary: Summary, tolerance: float) -> Figure:
    """Return bars of each joint's mean error and of its fraction within `tolerance` metres."""
    rows = _rows(summary)
    figure = new_figure(8.4, 0.9 + 0.32 * len(rows))
    errors, fractions = figure.subplots(1, 2, sharey=True)
    _draw_bars(errors, rows, lambda score: 100 * score.mean_error_m)
    errors.axvline(100 * summary.mean_error_m, color=FAINT, linewidth=0.8, linestyle='--')
    errors.set_title(f'mean error, cm (dashed: mean {100 * summary.mean_error_m:.1f})')
    _draw_bars(fractions, rows, lambda score: 100 * score.ap)
    fractions.axvline(100 * summary.map, color=FAINT, linewidth=0.8, linestyle='--')
    fractions.set_title(f'within {100 * tolerance:g} cm, % (dashed: mean {100 * summary.map:.1f})')
    fractions.set_xlim(0, 112)
    fractions.set_xticks(range(0, 101, 20))
    errors.set_yticks(range(len(rows)), rows)
    errors.set_ylim(len(rows) - 0.4, -0.6)
    labels = {'l_': "person's left", 'r_': "person's right", '': 'middle'}
    used = {side for parts in rows.values() for side in parts}
    add_legend_entries(
        figure,
        [
            Line2D([], [], color=_SIDES[side], linewidth=5, solid_capstyle='butt', label=label)
            for side, label in labels.items()
            if side in used
        ],
    )
    return figure


@house_style()
def error_curves(evaluation: Evaluation, tolerance: float) -> Figure:
    """Return the cumulative error curves of all joints, and of elbows, wrists and hands.

    A joint that was not estimated has an infinite error.
    """
    figure = new_figure(6.4, 3.6)
    axes = figure.subplots()
    axes.axvline(100 * tolerance, color=BORDER, linewidth=0.9)
    axes.text(100 * tolerance, 1.5, ' tolerance', color=FAINT, fontsize=8, va='bottom')
    groups = _groups(evaluation)
    for (name, errors), colour, dashes in zip(groups.items(), CURVES, _DASHES, strict=False):
        curve = cumulative(errors)
        axes.plot(
            curve.centimetres, curve.percent, color=colour, dashes=dashes, label=name,
            linewidth=2.0 if name == 'all joints' else 1.4,
        )  # fmt: skip
    axes.set_xlim(0, FARTHEST_CM)
    axes.set_ylim(0, 101)
    axes.set_xlabel('error, cm')
    axes.set_ylabel('joints within')
    axes.yaxis.set_major_formatter(PercentFormatter())
    axes.legend(loc='lower right')
    return figure


@house_style()
def reliability_plot(reliability: Reliability) -> Figure:
    """Return the fraction of joints that are near over their confidence, bin by bin.

    A histogram of the confidence is below.
    """
    figure = new_figure(4.2, 4.2)
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
    return figure


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
    groups = {'all joints': evaluation.errors.ravel()}
    for end in _LIMB_ENDS:
        mine = evaluation.errors[:, [end in name for name in names]].ravel()
        if not np.isnan(mine).all():
            groups[f'{end}s'] = mine
    return groups


def _rows(summary: Summary) -> dict[str, dict[str, JointScore]]:
    """Return the scores by side for each kind of joint, in the vocabulary's order."""
    rows: dict[str, dict[str, JointScore]] = {}
    for name, score in summary.joints.items():
        side = name[:2] if name[:2] in _SIDES else ''
        rows.setdefault(name.removeprefix(side), {})[side] = score
    return rows


def _draw_bars(
    axes: Axes,
    rows: dict[str, dict[str, JointScore]],
    value: Callable[[JointScore], float],
) -> None:
    """Draw a bar for each joint; left and right of a kind are in the same row."""
    for row, sides in enumerate(rows.values()):
        for position, (side, score) in enumerate(sides.items()):
            height = row + _BAR * (position - 0.5 * (len(sides) - 1))
            length = value(score)
            known = math.isfinite(length)
            axes.barh(height, length if known else 0, 0.9 * _BAR, color=_SIDES[side])
            text = axes.annotate(
                f'{length:.1f}' if known else 'no estimate',
                (length if known else 0, height),
                xytext=(2, 0),
                textcoords='offset points',
                va='center',
                fontsize=6.5,
            )
            text.set_path_effects([Stroke(linewidth=2, foreground='white'), Normal()])
    axes.tick_params(axis='y', length=0)
    axes.margins(x=0.12)
