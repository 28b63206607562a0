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

"""Segmentation without masks: in a room, with a learnt background, and in real images."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from room_scene import Person, Room, look, overlap

import lsc_pose_ros
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.segmentation.background import Background, empty_scene, remove_scene
from lsc_pose_ros.segmentation.blobs import BARRIER
from lsc_pose_ros.segmentation.nearest_body import NearestBody
from lsc_pose_ros.segmentation.people import People
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import SegmentationSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

RANGE = 0.4, 5.0
FRAME = 33_333_333
KINECT = Intrinsics(580.0, 580.0, 320.0, 240.0)
SOFA = ((-2.2, 0.2, 3.0), (0.0, 1.0, 4.0))
TABLE = ((-1.6, 0.3, 2.6), (-0.4, 1.0, 3.4))


def learnt(room: Room, *, width: int = 320, seconds: float = 0.2) -> Background:
    """A segmenter that has learnt the empty room."""
    background = Background(seconds, 0.1, *RANGE)
    number = 0
    while not background.ready:
        seen, _ = look(room, [], width=width, noise_seed=100 + number)
        background.learn(number * FRAME, seen.depth)
        number += 1
    return background


@pytest.mark.parametrize('seed', range(6))
def test_person_on_the_floor_is_segmented_completely(seed: int) -> None:
    random = np.random.default_rng(seed)
    room = Room(
        camera_height=random.uniform(0.8, 1.8),
        tilt=random.uniform(0, 12),
        turn=random.uniform(-15, 15),
        back=random.uniform(3.4, 5.5),
    )
    seen, camera = look(room, [Person(0.0, random.uniform(2.0, 2.8), seed)])
    labels = NearestBody(*RANGE).labels(seen.depth, camera)
    assert labels.dtype == np.int32
    assert set(np.unique(labels)) == {NO_BODY, 1}
    assert overlap(labels == 1, seen.labels == 1) > 0.96


@pytest.mark.parametrize(
    ('room', 'people'),
    [
        (Room(), [Person(-0.6, 2.8, 1), Person(0.6, 2.0, 2)]),
        (Room(), [Person(0.3, 2.9, 3), Person(0.0, 2.2, 4)]),  # one behind the other
        (Room(boxes=(SOFA,)), [Person(0.1, 2.4, 5)]),
        (Room(boxes=(TABLE,)), [Person(0.2, 2.4, 10)]),
        (Room(back=3.0), [Person(0.0, 2.75, 8)]),  # the back near the wall
        (Room(left=-0.7), [Person(-0.2, 2.3, 9)]),  # an arm near the wall
        (Room(back=9, left=-9, right=9, ceiling=9), [Person(0.2, 2.4, 11)]),
        (Room(camera_height=0.88, tilt=4.2, turn=4.8, back=4.1), [Person(-0.13, 2.26, 7)]),
    ],
)
def test_nearest_person_is_found_among_others_and_furniture(
    room: Room, people: list[Person]
) -> None:
    seen, camera = look(room, people)
    labels = NearestBody(*RANGE).labels(seen.depth, camera)
    nearest = 1 + min(range(len(people)), key=lambda index: people[index].z)
    assert overlap(labels == 1, seen.labels == nearest) > 0.95


def test_empty_room_has_no_body() -> None:
    for room in (Room(), Room(tilt=15, turn=30), Room(back=9, left=-9, right=9)):
        seen, camera = look(room, [])
        assert (NearestBody(*RANGE).labels(seen.depth, camera) == NO_BODY).all()


def test_bodies_out_of_range_are_ignored() -> None:
    seen, camera = look(Room(), [Person(0.0, 2.5)])
    for limits in ((0.4, 1.9), (3.0, 5.0)):
        labels = NearestBody(*limits).labels(seen.depth, camera)
        assert not (labels[seen.labels == 1] == 1).any()


@pytest.mark.parametrize('depth', [np.zeros((48, 64)), np.full((48, 64), 1.0), np.ones((1, 1))])
def test_degenerate_images_have_no_body(depth: np.ndarray) -> None:
    depth = depth.astype(np.float32)
    for segmenter in (NearestBody(*RANGE), Background(0.0, 0.1, *RANGE)):
        assert (segment(segmenter, 0, depth, KINECT) == NO_BODY).all()


@pytest.mark.parametrize(('wall', 'fraction'), [(0.0, 0.999), (3.0, 0.9)])
def test_real_people_from_the_waist_up(shared: Path, wall: float, fraction: float) -> None:
    """Kinect images whose background is cut away; in the last two somebody is farther back.

    A wall in place of the background fills the holes in the people, too, which costs a hand.
    """
    paths = sorted((shared / 'smoke' / 'skeltrack_upper').glob('depth-data-*'))
    assert len(paths) == 12
    several = {'depth-data-1399145206', 'depth-data-82823944'}
    for path in paths:
        depth = np.fromfile(path, '<u2').reshape(480, 640).astype(np.float32) / 1000
        expected = (depth > 0) & ((depth < 1.65) | (path.name not in several))
        depth = np.where(depth > 0, depth, np.float32(wall))
        labels = NearestBody(*RANGE).labels(depth, KINECT)
        assert overlap(labels == 1, expected) > fraction, path.name


@pytest.mark.parametrize(
    ('room', 'people'),
    [
        (Room(), [Person(-0.6, 2.8, 1), Person(0.6, 2.0, 2)]),
        (Room(boxes=(SOFA,)), [Person(-0.6, 2.75, 6)]),
        (Room(boxes=(((0.9, -1.6, 2.0), (1.2, 1.0, 2.3)),)), [Person(0.3, 2.5, 7)]),
        (Room(back=3.0), [Person(0.0, 2.75, 8)]),
    ],
)
def test_people_in_front_of_a_learnt_scene(room: Room, people: list[Person]) -> None:
    background = learnt(room)
    seen, camera = look(room, people)
    labels = background.labels(seen.depth, camera)
    found = range(1, labels.max() + 1)
    assert len(found) == len(people)
    sizes = [(seen.depth[labels == number] ** 2).sum() for number in found]
    assert sizes == sorted(sizes, reverse=True)
    for person in range(1, len(people) + 1):
        best = max(overlap(labels == number, seen.labels == person) for number in found)
        assert best > 0.95


def test_scene_is_learnt_for_the_given_duration() -> None:
    background = Background(1.0, 0.1, *RANGE)
    depth = np.full((48, 64), 3.0, np.float32)
    for number in range(30):
        assert (segment(background, number * FRAME, depth, KINECT) == NO_BODY).all()
        assert not background.ready
    background.learn(10**9, depth)
    assert background.ready


def test_learning_needs_little_memory_at_any_rate() -> None:
    background = Background(2.0, 0.1, *RANGE)
    depth = np.full((48, 64), 3.0, np.float32)
    for number in range(400):
        background.learn(number * 5_000_000, depth)
        assert len(background._seen) <= 15
    assert len(background._seen) >= 14


def test_restarted_recording_is_learnt_from_its_beginning() -> None:
    background = Background(1.0, 0.1, *RANGE)
    depth = np.full((48, 64), 3.0, np.float32)
    background.learn(5 * 10**9, depth)
    background.learn(2 * 10**9, depth)
    background.learn(3 * 10**9 - 1, depth)
    assert not background.ready
    background.learn(3 * 10**9, depth)
    assert background.ready


def test_new_image_size_starts_a_new_scene() -> None:
    background = Background(0.0, 0.1, *RANGE)
    background.learn(0, np.full((48, 64), 3.0, np.float32))
    assert background.ready
    other = np.full((24, 32), 3.0, np.float32)
    assert (background.labels(other, KINECT) == NO_BODY).all()
    background.learn(1, other)
    assert background.ready
    assert background.labels(other, KINECT).shape == other.shape


def test_scene_is_the_median_of_the_depths() -> None:
    random = np.random.default_rng(0)
    images = random.uniform(1, 4, (9, 12, 16)).astype(np.float32)
    images[random.random(images.shape) < 0.4] = 0
    images[:, :2] = 0
    scene = empty_scene(images)
    for row in range(12):
        for column in range(16):
            seen = np.sort(images[:, row, column][images[:, row, column] > 0])
            expected = seen[(len(seen) - 1) // 2] if len(seen) else np.inf
            assert scene[row, column] == expected


def test_person_who_walks_through_during_learning_is_not_in_the_scene() -> None:
    images = np.full((15, 4, 4), 3.0, np.float32)
    images[4:9] = 1.5
    assert (empty_scene(images) == 3.0).all()


def warning_after(people: Callable[[int], list[Person]], *, frames: int, room: Room) -> str:
    """Return what a segmenter warns of that learns from 6 of the frames."""
    background = Background(0.18, 0.1, *RANGE)
    for number in range(frames):
        seen, camera = look(room, people(number), noise_seed=number)
        segment(background, number * FRAME, seen.depth, camera)
    return background.warning


def test_nobody_during_learning_is_no_warning() -> None:
    room = Room(boxes=(SOFA, TABLE))

    def walk(number: int) -> list[Person]:
        return [Person(x=-1.5 + 0.1 * number)] if number > 8 else []

    assert warning_after(walk, frames=40, room=room) == ''


def test_person_who_walks_during_learning_is_a_warning() -> None:
    warning = warning_after(lambda number: [Person(x=-1.0 + 0.3 * number)], frames=8, room=Room())
    assert 'the scene was not empty while it was learnt: something moved in it' in warning


@pytest.mark.parametrize('sensor', ['kinect_v1', 'azure', 'tof'])
def test_person_who_moves_the_arms_is_in_the_scene_and_noise_is_not(sensor: str) -> None:
    settings = SyntheticSettings(frames=32, seed=2, sensor=sensor, rate=15.0, background=True)
    frames = list(synthetic_frames(settings))
    warnings = []
    for without in (False, True):
        background = Background(2.0, 0.1, *RANGE)
        for frame in frames:
            body = (frame.labels != NO_BODY) & without
            depth = np.where(body, np.float32(0), frame.depth)
            segment(background, frame.stamp, depth, frame.camera)
        assert background.ready
        warnings.append(background.warning)
    assert 'something moved in it' in warnings[0]
    assert warnings[1] == ''


def test_person_who_stands_in_the_scene_and_leaves_later_is_a_warning() -> None:
    def stand_and_walk(number: int) -> list[Person]:
        return [Person(x=-0.5 + 0.15 * max(0, number - 10))]

    warning = warning_after(stand_and_walk, frames=40, room=Room())
    assert 'has left it' in warning
    assert 'segmentation nearest' in warning


def test_removed_scene_is_that_of_numpy() -> None:
    random = np.random.default_rng(1)
    depth = random.uniform(0, 6, (30, 40)).astype(np.float32)
    depth[random.random(depth.shape) < 0.2] = 0
    scene = random.uniform(1, 6, depth.shape).astype(np.float32)
    scene[:3] = np.inf
    found = remove_scene(depth, scene, 0.1, 0.4, 5.0)
    body = (depth >= 0.4) & (depth <= 5.0) & (depth.astype(float) <= scene.astype(float) - 0.1)
    np.testing.assert_array_equal(
        found, np.where(depth == 0, 0, np.where(body, depth, BARRIER)).astype(np.float32)
    )


def test_settings_make_segmenters() -> None:
    assert make_segmenter(SegmentationSettings('mask')) is None
    assert isinstance(make_segmenter(SegmentationSettings('auto')), People)
    assert isinstance(make_segmenter(SegmentationSettings('people')), People)
    assert isinstance(make_segmenter(SegmentationSettings('nearest')), NearestBody)
    assert isinstance(make_segmenter(SegmentationSettings('background')), Background)


@pytest.mark.parametrize(
    ('settings', 'names'),
    [
        (SegmentationSettings('middle'), ['segmentation', 'mask or people or background']),
        (SegmentationSettings('nearest', 3.0, 2.0), ['range_min', 'range_max']),
    ],
)
def test_errors_name_the_bad_settings(settings: SegmentationSettings, names: list[str]) -> None:
    with pytest.raises(InputError) as error:
        make_segmenter(settings)
    for name in names:
        assert name in str(error.value)


@pytest.mark.parametrize('mode', ['people', 'nearest', 'background'])
def test_warm_up_compiles_everything(mode: str) -> None:
    """Run in a separate process, in which no other test has compiled kernels."""
    program = f"""
from numba.core.dispatcher import Dispatcher
from room_scene import Person, Room, look
from lsc_pose_ros.segmentation import background
from lsc_pose_ros.segmentation import blobs
from lsc_pose_ros.segmentation import background_planes as room
from lsc_pose_ros.segmentation import cell_labels, person_cells, person_instances
from lsc_pose_ros.body_parts import convolution, depth_grid, part_network
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import SegmentationSettings
from lsc_pose_ros.estimation.warm_up import warm_up_segmenter

def compiled():
    return {{
        (module.__name__, name): len(value.signatures)
        for module in (background, blobs, room, depth_grid, convolution,
                       part_network, cell_labels, person_cells, person_instances)
        for name, value in vars(module).items()
        if isinstance(value, Dispatcher)
    }}

settings = SegmentationSettings({mode!r}, background_seconds=0.0)
warm_up_segmenter(make_segmenter(settings), 0.0)
before = compiled()
segmenter = make_segmenter(settings)
empty, camera = look(Room(tilt=5), [])
segment(segmenter, 0, empty.depth, camera)
seen, camera = look(Room(tilt=5), [Person(-0.6, 2.8, 1), Person(0.6, 2.0, 2)])
assert (segment(segmenter, 1, seen.depth, camera) == 1).any()
assert compiled() == before, (before, compiled())
assert sum(before.values()) > 5
"""
    folders = [str(Path(lsc_pose_ros.__file__).parents[1]), str(Path(__file__).parent)]
    found = subprocess.run(
        [sys.executable, '-c', program],
        env=os.environ | {'PYTHONPATH': os.pathsep.join(folders)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stderr
