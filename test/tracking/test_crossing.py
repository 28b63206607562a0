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

"""Tracking of people who cross: numbers last over occlusions, absences and dropped frames."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.video_scores import VideoFrame, score_video
from lsc_pose_ros.synthetic.scene.placement import CameraConstraints
from lsc_pose_ros.synthetic.scene.walking_paths import sample_crossing_paths
from lsc_pose_ros.tracking.tracker import Tracker

SECOND = 1_000_000_000
HALF_WIDTH = 0.2  # of a body, metres
ERROR = 0.06  # of a joint, metres
CAMERA = Intrinsics(286.0, 286.0, 159.5, 119.5)

HEIGHTS = {
    'head': 1.6, 'neck': 1.4, 'torso': 1.2, 'pelvis': 0.95, 'shoulder': 1.4, 'elbow': 1.1,
    'wrist': 0.85, 'hand': 0.8, 'hip': 0.95, 'knee': 0.5, 'ankle': 0.1, 'foot': 0.05,
}  # fmt: skip
SIDES = {'l': 0.18, 'r': -0.18}


def skeleton(stature: float) -> np.ndarray:
    """Return a standing person at the origin, facing the camera, shape (20, 3)."""
    places = [
        (SIDES.get(name.split('_')[0], 0.0), -HEIGHTS[name.split('_')[-1]], 0.0)
        for name in JOINT_NAMES
    ]
    return stature / 1.75 * np.array(places)


def skeletons(numbers: list[int], positions: np.ndarray) -> Skeletons:
    positions = positions.reshape(-1, 20, 3).astype(np.float32)
    return Skeletons(
        np.array(numbers, np.uint16),
        np.arange(20, dtype=np.uint16),
        positions,
        np.full(positions.shape[:2], 0.8, np.float32),
    )


def crossing(seed: int, rate: float) -> list[VideoFrame]:
    """Return a minute in which three people cross, with noisy joints of those who are in view.

    Who is behind somebody is not seen, nor is who is out of the image. In one of 20 frames a body
    is turned round. The numbers of the bodies change in each frame.
    """
    rng = np.random.default_rng(seed)
    seconds = np.arange(int(60 * rate)) / rate
    constraints = CameraConstraints(
        CAMERA, 320, 240, (1.5, 5.0), (1.0, 1.0), (0.0, 0.0), cropped=False
    )
    walk = sample_crossing_paths(3, seconds, constraints, rng)
    middles = walk.placement.positions
    statures = rng.uniform(1.5, 1.95, 3)
    frames = []
    for n, second in enumerate(seconds):
        truth = np.array(
            [
                skeleton(stature) + path.positions[n] + middle
                for stature, path, middle in zip(statures, walk.paths, middles, strict=True)
            ]
        )
        seen = [person for person in range(3) if is_seen(truth[:, 0], person)]
        found = truth[seen] + rng.normal(0, ERROR, (len(seen), 20, 3))
        for body in found:
            if rng.random() < 0.05:
                body[4:12], body[12:20] = body[12:20].copy(), body[4:12].copy()
        numbers = sorted(rng.choice(np.arange(1, 9), len(seen), replace=False).tolist())
        frames.append(
            VideoFrame(
                round(second * SECOND),
                skeletons(numbers, found[rng.permutation(len(seen))]),
                skeletons([1, 2, 3], truth),
            )
        )
    return frames


def is_seen(heads: np.ndarray, person: int) -> bool:
    """Return whether enough of a person is in the image and not behind another one."""
    bearing = heads[:, 0] / heads[:, 2]
    if abs(bearing[person]) * CAMERA.fx > 160:
        return False
    nearer = heads[:, 2] < heads[person, 2]
    return not (nearer & (abs(bearing - bearing[person]) < HALF_WIDTH / heads[:, 2])).any()


def switches(frames: list[VideoFrame]) -> float:
    tracker = Tracker()
    tracked = [
        frame._replace(estimate=tracker.follow(frame.stamp, frame.estimate)) for frame in frames
    ]
    scores = score_video(tracked, 0.1)
    assert scores.map > 0.2  # most people are found
    return scores.id_switches_per_minute


@pytest.mark.parametrize('rate', [30.0, 10.0])
@pytest.mark.parametrize('seed', range(3))
def test_people_who_cross_for_a_minute_keep_their_numbers(seed: int, rate: float) -> None:
    frames = crossing(seed, rate)
    hidden = [3 - len(frame.estimate.bodies) for frame in frames]
    assert sum(hidden) > 0.05 * 3 * len(frames)
    assert switches(frames) <= 1.0
    # Without tracking the numbers change all the time.
    assert score_video(frames, 0.1).id_switches_per_minute > 100


def test_dropped_frames_change_no_number() -> None:
    frames = crossing(5, 30.0)
    kept = np.random.default_rng(0).random(len(frames)) < 0.5
    assert switches([frame for frame, keep in zip(frames, kept, strict=True) if keep]) <= 1.0


def walker(start: float, speed: float, second: float, stature: float = 1.75) -> np.ndarray:
    return skeleton(stature) + np.array([start + speed * second, 1.0, 3.0])


def follow(tracker: Tracker, second: float, *people: np.ndarray) -> list[int]:
    """Return the number of each of the people."""
    order = np.random.default_rng(round(1000 * second)).permutation(len(people))
    given = np.array([people[index] for index in order]).reshape(-1, 20, 3)
    found = tracker.follow(
        round(second * SECOND), skeletons(list(range(1, len(people) + 1)), given)
    )
    numbers = dict(zip(found.positions[:, 0, 0].tolist(), found.bodies.tolist(), strict=True))
    return [numbers[np.float32(person[0, 0])] for person in people]


@pytest.mark.parametrize('gap', [0.3, 0.6, 0.95])
def test_two_people_who_walk_through_an_occlusion_keep_their_numbers(gap: float) -> None:
    """Both are hidden when they pass each other: only their velocity tells who is who."""
    tracker, numbers = Tracker(), []
    for second in np.arange(0, 2, 1 / 30):
        if abs(second - 1.0) * 2 > gap:
            left, right = walker(-1.0, 1.0, second), walker(1.0, -1.0, second)
            numbers.append(follow(tracker, second, left, right))
        else:
            follow(tracker, second)
    assert numbers == [numbers[0]] * len(numbers)
    assert len(set(numbers[0])) == 2


def test_the_size_tells_who_comes_back() -> None:
    """A tall and a small person are hidden, and come back in each other's place."""
    for swapped in (False, True):
        tracker = Tracker()
        for second in np.arange(0, 1, 1 / 30):
            before = follow(tracker, second, walker(-0.2, 0, 0, 1.9), walker(0.2, 0, 0, 1.3))
        places = (0.05, -0.05) if swapped else (-0.05, 0.05)
        after = follow(tracker, 1.8, walker(places[0], 0, 0, 1.9), walker(places[1], 0, 0, 1.3))
        assert after == before
