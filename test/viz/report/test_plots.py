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

"""Plots of an evaluation."""

import numpy as np
import pytest
from matplotlib.artist import getp
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba

from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, JointScore, Summary
from lsc_pose_ros.viz.drawing.colours import LEFT, MIDDLE, RIGHT
from lsc_pose_ros.viz.report.plots import (
    cumulative,
    error_curves,
    joint_bars,
    part_entries,
    reliability_plot,
    side_entries,
)

TOLERANCE = 0.1


def test_cumulative_counts_what_is_within() -> None:
    rng = np.random.default_rng(1)
    errors = rng.gamma(2, 0.05, 200).astype(np.float32)
    errors[:20], errors[20:40] = np.nan, np.inf
    curve = cumulative(errors)
    labelled = errors[~np.isnan(errors)]
    wanted = [(labelled <= limit / 100).mean() * 100 for limit in curve.centimetres]
    np.testing.assert_allclose(curve.percent, wanted)
    assert curve.percent[-1] < 90


def test_cumulative_of_nothing_is_flat() -> None:
    assert (cumulative(np.full(3, np.nan, np.float32)).percent == 0).all()


def bar_sizes(axes: Axes, size: str) -> list[float]:
    """Return the width or height of each bar."""
    return [getp(bar, size) for bar in axes.patches]


def test_bars_are_as_long_as_the_scores_and_name_missing_estimates() -> None:
    summary = Summary(
        0.04,
        0.5,
        {
            'neck': JointScore(0.03, 0.75, 8),
            'l_hand': JointScore(0.05, 0.25, 8),
            'r_hand': JointScore(float('nan'), 0.0, 8),
        },
    )
    charts = joint_bars(summary, TOLERANCE)
    errors, fractions = (chart.figure.axes[0] for chart in charts)
    assert bar_sizes(errors, 'width') == pytest.approx([3, 5, 0])
    assert bar_sizes(fractions, 'width') == pytest.approx([75, 25, 0])
    assert 'no estimate' in [text.get_text() for text in errors.texts]
    assert [label.get_text() for label in errors.get_yticklabels()] == ['neck', 'hand']
    assert 'shortest is neck with 3.0 cm, the longest l_hand with 5.0 cm' in charts[0].seen
    assert [entry.get_label() for entry in side_entries(summary.joints)] == [
        "person's left",
        "person's right",
        'middle',
    ]
    colours = [getp(bar, 'facecolor') for bar in errors.patches]
    assert colours == [to_rgba(colour) for colour in (MIDDLE, LEFT, RIGHT)]


def test_curves_have_the_limb_ends_that_are_labelled(evaluation: Evaluation) -> None:
    without_hands = evaluation._replace(
        joints=evaluation.joints[:6], errors=evaluation.errors[:, :6]
    )
    entries = part_entries(without_hands)
    assert [entry.get_label() for entry in entries] == ['all joints', 'elbows', 'wrists']
    axes = error_curves(without_hands, TOLERANCE).figure.axes[0]
    assert [line.get_color() for line in axes.lines[1:]] == [each.get_color() for each in entries]


def test_alternative_text_of_the_curves_has_the_fractions_within(evaluation: Evaluation) -> None:
    labelled = evaluation.errors[~np.isnan(evaluation.errors)]
    wanted = f'all joints {100 * (labelled <= TOLERANCE).mean():.1f} %'
    assert wanted in error_curves(evaluation, TOLERANCE).seen


def test_reliability_is_drawn_bin_by_bin(evaluation: Evaluation) -> None:
    reliability = measure_reliability(evaluation)
    fractions, counts = reliability_plot(reliability).figure.axes
    drawn = fractions.lines[1].get_xydata()
    wanted = [(100 * each.confidence, 100 * each.fraction) for each in reliability.bins]
    np.testing.assert_allclose(drawn, wanted)
    assert sum(bar_sizes(counts, 'height')) == pytest.approx(100)
