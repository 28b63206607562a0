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

"""The stature of a body: independent of its posture, and unknown without its joints."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.pose.inference.stature import SKELETON_TO_STATURE, statures
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.synthetic.settings import SyntheticSettings

ALL = np.arange(len(JOINT_NAMES), dtype=np.uint16)
NEEDED = ('head', 'neck', 'torso', 'pelvis')


def twin(body: np.ndarray) -> float:
    def between(first: str, second: str) -> float:
        return float(np.linalg.norm(body[JOINT_NUMBERS[first]] - body[JOINT_NUMBERS[second]]))

    legs = [between(f'{s}_hip', f'{s}_knee') + between(f'{s}_knee', f'{s}_ankle') for s in 'lr']
    legs = [leg for leg in legs if not np.isnan(leg)]
    trunk = between('head', 'neck') + between('neck', 'torso') + between('torso', 'pelvis')
    return SKELETON_TO_STATURE * (trunk + (sum(legs) / len(legs) if legs else float('nan')))


@pytest.mark.parametrize('unknown', [0.0, 0.05, 0.3])
def test_it_is_the_length_along_the_joints(unknown: float) -> None:
    rng = np.random.default_rng(0)
    positions = rng.normal(0, 0.3, (40, 20, 3)).astype(np.float32)
    positions[rng.random((40, 20)) < unknown] = np.nan
    found = statures(positions, ALL)
    np.testing.assert_allclose(found, [twin(body) for body in positions], rtol=1e-5)
    order = rng.permutation(20)
    np.testing.assert_array_equal(statures(positions[:, order], ALL[order]), found)


@pytest.mark.parametrize('missing', [*NEEDED, 'l_knee'])
def test_it_is_unknown_if_the_model_does_not_estimate_a_joint(missing: str) -> None:
    positions = np.ones((2, 20, 3), np.float32)
    kept = JOINT_NUMBERS[missing] != ALL
    found = statures(positions[:, kept], ALL[kept])
    # The other leg is enough.
    assert np.isnan(found).all() == (missing in NEEDED)


def test_nobody_has_no_stature() -> None:
    assert statures(np.zeros((0, 20, 3), np.float32), ALL).shape == (0,)


@pytest.mark.parametrize(('stature', 'age'), [((1.0, 1.02), (4, 6)), ((1.8, 1.82), (20, 60))])
def test_it_is_that_of_the_synthetic_people(
    stature: tuple[float, float], age: tuple[float, float]
) -> None:
    """Postures bend the trunk, which the joints follow in three pieces only: 4 %."""
    settings = SyntheticSettings(
        frames=6, clip_length=2, seed=1, stature=stature, age=age, width=64, height=48
    )
    for frame in synthetic_frames(settings):
        assert frame.ground_truth is not None
        found = statures(frame.ground_truth.positions, ALL)
        np.testing.assert_allclose(found, np.mean(stature), rtol=0.04)
