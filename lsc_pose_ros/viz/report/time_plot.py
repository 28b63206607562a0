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


"""One joint of a video over time: ground truth, and what was estimated in several ways."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.canvas import CHART_WIDTH, house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import GROUND_TRUTH, curve_look
from lsc_pose_ros.viz.report.plots import curve_entry

SECONDS = 6.0
"""The plot shows so much of the video."""

_BAND = 4.0  # the width of the ground truth, points
_AXES = ('right', 'down', 'away')


@house_style()
def joint_over_time(
    ways: Mapping[str, Sequence[VideoFrame]], joint: str, width: float = CHART_WIDTH
) -> Figure:
    """Return the coordinates of a joint of the first person over time, in metres.

    Args:
        ways: the frames of the same video by the name of the estimation.
        joint: the name of the joint, which the title gives.
        width: of the figure, inches.
    """
    figure = new_figure(width, 5.4)
    rows = figure.subplots(3, 1, sharex=True)
    first = next(iter(ways.values()))
    number = np.array([JOINT_NUMBERS[joint]], np.uint16)
    person = next(int(frame.truth.bodies[0]) for frame in first if len(frame.truth.bodies))
    shown = [frame for frame in first if frame.stamp - first[0].stamp <= SECONDS * 1e9]
    times = np.array([(frame.stamp - first[0].stamp) * 1e-9 for frame in shown])
    truth = _positions([frame.truth for frame in shown], number, person)
    estimates = [
        _positions([frame.estimate for frame in frames[: len(shown)]], number, None)
        for frames in ways.values()
    ]
    for axis, row in enumerate(rows):
        row.plot(times, truth[:, axis], color=GROUND_TRUTH, linewidth=_BAND)
        for way, positions in enumerate(estimates):
            look = curve_look(way)
            row.plot(
                times, positions[:, axis], color=look.colour, dashes=look.dashes, linewidth=1.2
            )
        row.set_ylabel(f'{_AXES[axis]}, m')
    rows[0].set_title(joint, loc='left')
    rows[-1].set_xlabel('seconds')
    return figure


def way_entries(ways: Iterable[str]) -> list[Line2D]:
    """Return the legend of the ground truth and of the estimation in each way."""
    truth = Line2D(
        [], [], color=GROUND_TRUTH, linewidth=_BAND, solid_capstyle='butt', label='ground truth'
    )
    return [truth, *(curve_entry(curve_look(way), name) for way, name in enumerate(ways))]


def _positions(
    bodies: Sequence[Skeletons], number: NDArray[np.uint16], person: int | None
) -> NDArray[np.float32]:
    """Return a joint of one person, or of the first body, in each frame, shape (n, 3)."""
    positions = np.full((len(bodies), 3), np.nan, np.float32)
    for row, each in enumerate(bodies):
        numbers = each.bodies.tolist()
        index = 0 if person is None else numbers.index(person) if person in numbers else -1
        if 0 <= index < len(numbers):
            positions[row] = select_joints(each, number)[index, 0]
    return positions
