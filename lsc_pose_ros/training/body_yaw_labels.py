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

"""Writes the body yaw of labelled people into the training samples, as features of the forest."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.forest.body_yaw import BODY_YAW_SIZE, body_yaw_of, body_yaw_quantised
from lsc_pose_ros.training.samples import Samples

BODY_YAWS = 8
"""Number of yaws that the estimator tries; votes agree up to half a step off."""

# Standard deviation of the noise of a yaw, radians: about that of the closest of BODY_YAWS.
_UNCERTAINTY = np.radians(12.0)

# The lines from right to left of these joints lie across the trunk.
_ACROSS = ('shoulder', 'hip')


def body_yaws_of_people(
    joints: NDArray[np.float32], numbers: NDArray[np.uint16]
) -> NDArray[np.float64]:
    """Return the body yaw of P people, radians, as `body_yaw_of`; NaN if unknown, shape (P,).

    Args:
        joints: positions in any unit, NaN if not labelled, shape (P, J, 3).
        numbers: the joint numbers, shape (J,).

    Raises:
        InputError: as `left_right_columns`.
    """
    across = np.zeros((len(joints), 3))
    for left, right in left_right_columns(numbers):
        line = joints[:, left] - joints[:, right]
        across += line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    return body_yaw_of(across)


def left_right_columns(numbers: NDArray[np.uint16]) -> list[tuple[int, int]]:
    """Return the columns of (left, right) shoulder and (left, right) hip.

    Args:
        numbers: the joint numbers, shape (J,).

    Raises:
        InputError: one of the four joints is missing.
    """
    names = names_of(numbers)
    pairs = [(f'l_{name}', f'r_{name}') for name in _ACROSS]
    missing = [name for pair in pairs for name in pair if name not in names]
    if missing:
        msg = (
            'the body yaw is computed from shoulders and hips; '
            f'also learn {", ".join(missing)}, or leave out --body-yaw'
        )
        raise InputError(msg)
    return [(names.index(left), names.index(right)) for left, right in pairs]


def write_body_yaws(samples: Samples, numbers: NDArray[np.uint16], seed: int) -> None:
    """Write the body yaw of each person, with noise, into the last rows of the samples.

    At estimation the yaw is one of BODY_YAWS, so the forest must tolerate an error. An unknown yaw
    is drawn at random.

    Args:
        samples: the last BODY_YAW_SIZE rows of `quantised` are filled.
        numbers: the joint numbers, shape (J,).
        seed: seed of the noise.

    Raises:
        InputError: as `left_right_columns`, or no body yaw is known.
    """
    body_yaw = body_yaws_of_people(samples.joints, numbers)
    if not np.isfinite(body_yaw).any():
        msg = 'nobody is labelled with both shoulders and both hips; leave out --body-yaw'
        raise InputError(msg)
    random = np.random.default_rng((seed, len(body_yaw)))
    noisy = body_yaw + _UNCERTAINTY * random.standard_normal(len(body_yaw))
    unknown = np.isnan(body_yaw)
    noisy[unknown] = 2 * np.pi * random.random(unknown.sum())
    samples.quantised[-BODY_YAW_SIZE:] = body_yaw_quantised(noisy)[samples.person].T
