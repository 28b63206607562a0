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

"""Habitual postures: distributions of the joint angles of arms, legs or trunk."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS
from lsc_pose_ros.synthetic.sampling import RandomStream

Posture = dict[str, tuple[float, float]]
"""Mean and deviation of angles, degrees; angles that are not named have 0 and 6."""

_DEFAULT = (0.0, 6.0)

HANGING: Posture = {
    'plane': (20, 30), 'elevation': (13, 5), 'axial': (-10, 20), 'elbow': (16, 10),
    'pronation': (20, 28), 'fingers': (18, 10),
}  # fmt: skip

ARM_POSTURES: tuple[tuple[float, Posture], ...] = (
    (0.13, {  # held out sideways
        'plane': (0, 18), 'elevation': (85, 22), 'axial': (10, 35), 'elbow': (15, 18),
        'pronation': (20, 40), 'fingers': (10, 14),
    }),
    (0.12, {  # reaching forwards
        'plane': (84, 24), 'elevation': (78, 24), 'axial': (-10, 25), 'elbow': (25, 25),
        'pronation': (30, 40), 'fingers': (12, 16),
    }),
    (0.13, {  # overhead
        'plane': (40, 35), 'elevation': (148, 16), 'axial': (10, 30), 'elbow': (30, 30),
        'pronation': (0, 40), 'fingers': (14, 18),
    }),
    (0.16, {  # waving
        'plane': (15, 24), 'elevation': (65, 22), 'axial': (72, 16), 'elbow': (90, 28),
        'pronation': (30, 30), 'fingers': (5, 8),
    }),
    (0.08, {  # a hand on the hip
        'plane': (-18, 10), 'elevation': (42, 6), 'axial': (-48, 8), 'elbow': (92, 8),
        'wrist_flexion': (20, 15), 'fingers': (20, 15),
    }),
    (0.08, {  # a hand to the face
        'plane': (65, 15), 'elevation': (58, 15), 'axial': (-15, 12), 'elbow': (124, 12),
        'pronation': (0, 40), 'fingers': (30, 25),
    }),
    (0.10, {  # across the chest
        'plane': (75, 15), 'elevation': (55, 18), 'axial': (-50, 12), 'elbow': (75, 24),
        'pronation': (20, 30), 'fingers': (20, 20),
    }),
    (0.12, {  # the forearm forwards
        'plane': (30, 35), 'elevation': (18, 9), 'axial': (-5, 25), 'elbow': (88, 24),
        'pronation': (10, 50), 'fingers': (25, 25),
    }),
    (0.04, {  # behind the back
        'plane': (-55, 10), 'elevation': (32, 8), 'axial': (-58, 8), 'elbow': (78, 16),
        'pronation': (20, 30), 'fingers': (25, 15),
    }),
    (0.07, {  # thrown back
        'plane': (-45, 20), 'elevation': (62, 18), 'axial': (20, 35), 'elbow': (40, 35),
        'pronation': (10, 40), 'fingers': (45, 30),
    }),
)  # fmt: skip


def sample_posture(
    angles: NDArray[np.float64],
    prefix: str,
    names: Sequence[str],
    posture: Posture,
    stream: RandomStream,
) -> None:
    """Sample the angles called `prefix` and one of `names` from `posture`, in place, radians."""
    for name in names:
        mean, deviation = posture.get(name, _DEFAULT)
        angles[ANGLE_NUMBERS[prefix + name]] = np.radians(stream.normal(mean, deviation))
