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

"""Tells the forest, in training, where people face, so that it learns to be told."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.forest.body_yaw import BODY_YAW_SIZE, body_yaw_of, body_yaw_quantised
from lsc_pose_ros.training.samples import Samples

BODY_YAWS = 8
"""How many directions are tried later: half of one apart, votes still agree."""

# How far off what is told is, as a standard deviation, radians: that of a direction among FACINGS.
_UNCERTAINTY = np.radians(12.0)

# Left and right of these lie across the trunk.
_ACROSS = ('shoulder', 'hip')


def people_facing(joints: NDArray[np.float32], numbers: NDArray[np.uint16]) -> NDArray[np.float64]:
    """Return where people face, radians, as `body_yaw_of`, NaN where it is not known, shape (P,).

    Args:
        joints: their places, NaN where not labelled, any unit, shape (P, J, 3).
        numbers: which joints these are, shape (J,).

    Raises:
        InputError: as `lines_across`.
    """
    across = np.zeros((len(joints), 3))
    for left, right in lines_across(numbers):
        line = joints[:, left] - joints[:, right]
        across += line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    return body_yaw_of(across)


def lines_across(numbers: NDArray[np.uint16]) -> list[tuple[int, int]]:
    """Return the columns of the left and the right shoulder, and of the left and the right hip.

    Args:
        numbers: which joints there are, shape (J,).

    Raises:
        InputError: these four are not among them.
    """
    names = names_of(numbers)
    pairs = [(f'l_{name}', f'r_{name}') for name in _ACROSS]
    missing = [name for pair in pairs for name in pair if name not in names]
    if missing:
        msg = (
            'where people face is told by shoulders and hips; '
            f'also learn {", ".join(missing)}, or leave out --facing'
        )
        raise InputError(msg)
    return [(names.index(left), names.index(right)) for left, right in pairs]


def tell_body_yaw(samples: Samples, numbers: NDArray[np.uint16], seed: int) -> None:
    """Write into samples where each person faces, a little off, as the forest will be told.

    Args:
        samples: the last FACING_SIZE rows of their levels are free, and are filled.
        numbers: which joints the samples have, shape (J,).
        seed: of what is drawn.

    Raises:
        InputError: as `people_facing`, or nobody's facing is known.
    """
    body_yaw = people_facing(samples.joints, numbers)
    if not np.isfinite(body_yaw).any():
        msg = 'nobody is labelled with both shoulders and both hips; leave out --facing'
        raise InputError(msg)
    random = np.random.default_rng((seed, len(body_yaw)))
    told = body_yaw + _UNCERTAINTY * random.standard_normal(len(body_yaw))
    unknown = np.isnan(body_yaw)
    told[unknown] = 2 * np.pi * random.random(unknown.sum())
    samples.quantised[-BODY_YAW_SIZE:] = body_yaw_quantised(told)[samples.person].T
