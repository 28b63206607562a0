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

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER, CURVES

SECONDS = 6.0
"""The plot shows so much of the video."""

_AXES = ('right', 'down', 'away from the camera')


@house_style()
def joint_over_time(ways: Mapping[str, Sequence[VideoFrame]], joint: str) -> Figure:
    """Return the coordinates of a joint of the first person over time, in metres.

    Args:
        ways: the frames of the same video by the name of the estimation.
        joint: the name of the joint, which the title gives.
    """
    figure = new_figure(8.4, 5.4)
    rows = figure.subplots(3, 1, sharex=True)
    first = next(iter(ways.values()))
    number = np.array([JOINT_NUMBERS[joint]], np.uint16)
    person = int(first[0].truth.bodies[0])
    shown = [frame for frame in first if frame.stamp - first[0].stamp <= SECONDS * 1e9]
    times = np.array([(frame.stamp - first[0].stamp) * 1e-9 for frame in shown])
    curves = {'ground truth': _positions([frame.truth for frame in shown], number, person)}
    for name, frames in ways.items():
        estimates = [frame.estimate for frame in frames[: len(shown)]]
        curves[name] = _positions(estimates, number, None)
    for axis, row in enumerate(rows):
        for (name, positions), colour in zip(curves.items(), (BORDER, *CURVES), strict=False):
            width = 3.0 if name == 'ground truth' else 1.2
            row.plot(times, positions[:, axis], color=colour, linewidth=width, label=name)
        row.set_ylabel(f'{_AXES[axis]}, m')
    rows[0].legend(loc='lower right', bbox_to_anchor=(1, 1), ncols=len(curves), frameon=False)
    rows[0].set_title(joint, loc='left')
    rows[-1].set_xlabel('seconds')
    return figure


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
