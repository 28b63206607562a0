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

"""Tests sections of clips: resampling and the limit of the yaw."""

import numpy as np
import pytest
from captured_poses import possible_pose

from lsc_pose_ros.synthetic.mocap.clip_section import resample, within_yaw


def test_resampling_at_the_frames_returns_the_frames(clip_of):
    random = np.random.default_rng(9)
    clip = clip_of([possible_pose(random) for _ in range(5)], frame_time=1.0)
    section = resample(clip, np.arange(5) / clip.rate)
    same = abs((section.orientations * clip.orientations).sum(axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-6)
    np.testing.assert_allclose(section.heading, clip.heading, atol=1e-9)


@pytest.mark.parametrize('widest', [0.3, 1.0, np.pi])
def test_yaw_stays_within_the_limit(widest):
    random = np.random.default_rng(3)
    for heading in (np.zeros(5), np.linspace(2, 2.4, 9), np.linspace(-8, 5, 40)):
        yaws = np.array([within_yaw(heading, widest, random) for _ in range(50)])
        if widest < np.pi:
            assert abs(yaws).max() <= widest + 1e-9
        spare = np.ptp(heading) < 2 * widest
        if spare:
            np.testing.assert_allclose(np.diff(yaws, axis=1), np.diff(heading)[None].repeat(50, 0))
            assert np.ptp(yaws[:, 0]) > 0.5 * (2 * widest - np.ptp(heading))
