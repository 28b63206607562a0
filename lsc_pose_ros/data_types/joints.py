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

"""The joints: their numbers, their names, and the trees that connect them.

Names follow REP-155 where it defines one. Left and right are the person's own.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError

JOINT_NAMES: tuple[str, ...] = (
    'head', 'neck', 'torso', 'pelvis',
    'l_shoulder', 'l_elbow', 'l_wrist', 'l_hand', 'l_hip', 'l_knee', 'l_ankle', 'l_foot',
    'r_shoulder', 'r_elbow', 'r_wrist', 'r_hand', 'r_hip', 'r_knee', 'r_ankle', 'r_foot',
)  # fmt: skip
"""The names of all joints; a joint's number is its index."""

JOINT_NUMBERS: dict[str, int] = {name: number for number, name in enumerate(JOINT_NAMES)}
"""The number of each joint, by name."""

# The joints that `train` learns by default: the 17 of the paper.
DEFAULT_JOINTS: tuple[str, ...] = tuple(
    name for name in JOINT_NAMES if name not in {'pelvis', 'l_foot', 'r_foot'}
)

# The parent of each joint (paper, Fig. 3a). The neck is the root of the upper body, the pelvis of
# the lower body; no edge connects the two.
PARENTS: dict[str, str] = {
    'head': 'neck',
    'torso': 'neck',
    'l_shoulder': 'neck',
    'l_elbow': 'l_shoulder',
    'l_wrist': 'l_elbow',
    'l_hand': 'l_wrist',
    'r_shoulder': 'neck',
    'r_elbow': 'r_shoulder',
    'r_wrist': 'r_elbow',
    'r_hand': 'r_wrist',
    'l_hip': 'pelvis',
    'l_knee': 'l_hip',
    'l_ankle': 'l_knee',
    'l_foot': 'l_ankle',
    'r_hip': 'pelvis',
    'r_knee': 'r_hip',
    'r_ankle': 'r_knee',
    'r_foot': 'r_ankle',
}


def numbers_of(names: Iterable[str]) -> NDArray[np.uint16]:
    """Return the numbers of the joints called `names`, sorted and without repetition, shape (J,).

    Raises:
        InputError: a name is unknown, or `names` is empty.
    """
    wanted = set(names)
    unknown = sorted(wanted - set(JOINT_NUMBERS))
    if unknown:
        msg = f'unknown joint {", ".join(unknown)}; the joints are {", ".join(JOINT_NAMES)}'
        raise InputError(msg)
    if not wanted:
        msg = 'no joint is named; name at least one'
        raise InputError(msg)
    return np.array(sorted(JOINT_NUMBERS[name] for name in wanted), dtype=np.uint16)


def names_of(numbers: NDArray[np.uint16] | Sequence[int]) -> list[str]:
    """Return the names of the joints `numbers`, shape (J,)."""
    return [JOINT_NAMES[int(number)] for number in numbers]


def default_edges(numbers: NDArray[np.uint16] | Sequence[int]) -> NDArray[np.int32]:
    """Return the paper's two trees as pairs (parent, child) of indices into `numbers`, (E, 2).

    If the parent of a joint is not in `numbers`, its nearest ancestor in `numbers` replaces it. If
    the root is missing, the descendant with the lowest number replaces it.
    """
    names = names_of(numbers)
    index = {name: position for position, name in enumerate(names)}
    substitute: dict[str, str] = {}
    edges: list[tuple[int, int]] = []
    for name in names:
        ancestor = name
        while ancestor in PARENTS:
            ancestor = PARENTS[ancestor]
            if ancestor in index:
                break
        if ancestor == name:  # a root
            continue
        if ancestor not in index:
            ancestor = substitute.setdefault(ancestor, name)
        if ancestor != name:
            edges.append((index[ancestor], index[name]))
    return np.array(edges, dtype=np.int32).reshape(-1, 2)


def drawn_edges(numbers: NDArray[np.uint16] | Sequence[int]) -> NDArray[np.int32]:
    """Return `default_edges` and the line from the trunk to the pelvis, if it is known, (E, 2).

    The method knows no such bone: its two trees are apart. People see one body.
    """
    names = names_of(numbers)
    edges = default_edges(numbers)
    above = [name for name in ('torso', 'neck') if name in names]
    if 'pelvis' not in names or not above:
        return edges
    spine = np.array([[names.index(above[0]), names.index('pelvis')]], np.int32)
    return np.concatenate([edges, spine])


def leg_pairs(numbers: NDArray[np.uint16] | Sequence[int]) -> NDArray[np.int32]:
    """Return the pairs of knees, ankles and feet in `numbers` as indices (left, right), (P, 2).

    Hips are not included, because their positions are never exchanged.
    """
    names = names_of(numbers)
    pairs = [(f'l_{part}', f'r_{part}') for part in ('knee', 'ankle', 'foot')]
    known = [pair for pair in pairs if set(pair) <= set(names)]
    return np.array(
        [(names.index(left), names.index(right)) for left, right in known], dtype=np.int32
    ).reshape(-1, 2)
