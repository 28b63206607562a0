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

"""People who walk across the view: their paths, their steps, and the frames that show them."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.scene.placement import CameraConstraints
from lsc_pose_ros.synthetic.scene.walking_paths import (
    BODY_DEPTH,
    SPEEDS,
    CrossingPaths,
    sample_crossing_paths,
)
from lsc_pose_ros.synthetic.settings import camera_of, check

SETTINGS = SyntheticSettings(
    frames=12, clip_length=120, rate=3.0, people=3, distance=(1.5, 5.0), noise='none',
    crossing=True, seed=2,
)  # fmt: skip
SECONDS = np.arange(1800) / 30


def paths(seed: int, people: int = 3, farthest: float = 5.0) -> CrossingPaths:
    constraints = CameraConstraints(
        camera_of(SETTINGS), 320, 240, (1.5, farthest), (0.5, 2.0), (0.0, 0.3), cropped=False
    )
    return sample_crossing_paths(people, SECONDS, constraints, np.random.default_rng(seed))


@pytest.mark.parametrize('seed', range(4))
def test_people_walk_steadily_in_the_direction_that_they_face(seed: int) -> None:
    for path in paths(seed).paths:
        steps = np.diff(path.positions, axis=0)
        speed = np.linalg.norm(steps, axis=1) * 30
        # A chord of a turn is a little shorter than its arc.
        assert SPEEDS[0] * 0.98 < speed.min() <= speed.max() < SPEEDS[1] * 1.0001
        np.testing.assert_allclose(np.diff(path.distance) * 30, speed, rtol=0.02)
        ahead = np.stack([np.sin(path.yaw), -np.cos(path.yaw)], axis=1)[:-1]
        along = (ahead * steps[:, [0, 2]]).sum(axis=1) * 30
        assert (along > 0.95 * speed).all()


@pytest.mark.parametrize('seed', range(4))
def test_people_never_touch_but_pass_before_each_other(seed: int) -> None:
    crossing = paths(seed)
    at = [
        path.positions + middle
        for path, middle in zip(crossing.paths, crossing.placement.positions, strict=True)
    ]
    for first, second in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(at[first][:, 2] - at[second][:, 2]).min() >= BODY_DEPTH - 1e-9
        bearing = at[first][:, 0] / at[first][:, 2] - at[second][:, 0] / at[second][:, 2]
        assert (np.diff(np.sign(bearing)) != 0).sum() >= 4


def test_too_many_lanes_are_refused() -> None:
    with pytest.raises(InputError, match=r'give a largest distance of 3\.9 m or more'):
        paths(0, people=3, farthest=3.8)
    paths(0, people=3, farthest=3.91)


def test_the_frames_show_people_on_their_way() -> None:
    frames = list(synthetic_frames(SETTINGS))
    truth = np.array([frame.ground_truth.positions for frame in frames])
    torso = truth[:, :, JOINT_NUMBERS['torso']]
    moved = np.linalg.norm(np.diff(torso, axis=0), axis=2)
    assert (moved.sum(axis=0) > 0.5 * SPEEDS[0] * 11 / 3).all()
    # Lengths of limbs stay the same.
    thigh = np.linalg.norm(
        truth[:, :, JOINT_NUMBERS['l_hip']] - truth[:, :, JOINT_NUMBERS['l_knee']], axis=2
    )
    np.testing.assert_allclose(thigh, thigh[:1].repeat(12, axis=0), rtol=1e-3)
    for frame in frames:
        assert set(np.unique(frame.labels)) <= {NO_BODY, 1, 2, 3}
        # What is seen of a person is where the person is.
        for number in np.unique(frame.labels[frame.labels >= 0]).tolist():
            own = frame.ground_truth.positions[number - 1]
            depths = frame.depth[(frame.labels == number) & (frame.depth > 0)]
            assert own[:, 2].min() - 0.3 < depths.min() <= depths.max() < own[:, 2].max() + 0.3
    again = list(synthetic_frames(SETTINGS._replace(frames=2)))
    np.testing.assert_array_equal(again[1].depth, frames[1].depth)


def test_settings_that_contradict_are_refused() -> None:
    with pytest.raises(InputError, match='give its frame rate'):
        check(SETTINGS._replace(rate=None))
    with pytest.raises(InputError, match='without furniture'):
        check(SETTINGS._replace(furniture=True))
