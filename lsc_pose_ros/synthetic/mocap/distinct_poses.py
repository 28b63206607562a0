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

"""Differences between captured poses, and the selection of distinct ones."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS


def distinct_poses(
    reference_joints: NDArray[np.float64], frames: NDArray[np.intp], apart: float
) -> NDArray[np.intp]:
    """Return those of `frames` whose poses differ by at least `apart` metres, in order."""
    kept = [int(frames[0])]
    for frame in frames[1:]:
        if np.round(pose_distance(reference_joints[frame], reference_joints[kept]), 6) >= apart:
            kept.append(int(frame))
    return np.array(kept)


def pose_distance(pose: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """Return the smallest difference of `pose`, (J, 3), from `others`, (N, J, 3), metres.

    The difference of two poses is the largest distance between corresponding joints.
    """
    moved = ((others - pose) ** 2).sum(axis=-1).max(axis=-1)
    return float(np.sqrt(moved.min()))


# The segments of a person of 1.70 m (R. Drillis and R. Contini, Body segment parameters, 1966):
# name, parent, start in the parent's frame and end in the segment's own frame, metres.
_OUTLINE: tuple[tuple[str, str, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ('chest', 'pelvis', (0.0, 0.16, 0.0), (0.0, 0.33, 0.0)),
    ('head', 'chest', (0.0, 0.33, 0.0), (0.0, 0.22, 0.0)),
    *(
        (f'{letter}_{name}', f'{letter}_{parent}' if parent not in ('chest', 'pelvis') else parent,
         start, (0.0, -length, ahead))
        for letter, side in (('l', 1.0), ('r', -1.0))
        for name, parent, start, length, ahead in (
            ('upper_arm', 'chest', (side * 0.22, 0.27, 0.0), 0.316, 0.0),
            ('forearm', 'upper_arm', (0.0, -0.316, 0.0), 0.248, 0.0),
            ('hand', 'forearm', (0.0, -0.248, 0.0), 0.184, 0.0),
            ('thigh', 'pelvis', (side * 0.09, 0.0, 0.0), 0.417, 0.0),
            ('shank', 'thigh', (0.0, -0.417, 0.0), 0.418, 0.0),
            ('foot', 'shank', (0.0, -0.418, 0.0), 0.06, 0.19),
        )
    ),
)  # fmt: skip


def reference_joints(orientations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the ends of the segments of an average person, metres, shape (T, 14, 3).

    Args:
        orientations: of all segments, shape (T, S, 3, 3).
    """
    starts: dict[str, NDArray[np.float64]] = {'pelvis': np.zeros((len(orientations), 3))}
    ends = []
    for name, parent, start, end in _OUTLINE:
        turn = orientations[:, SEGMENTS.index(parent)]
        starts[name] = starts[parent] + turn @ np.array(start)
        ends.append(starts[name] + orientations[:, SEGMENTS.index(name)] @ np.array(end))
    return np.stack(ends, axis=1)
