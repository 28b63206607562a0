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

"""The worst frames of a check: their choice, their words, and the joints that are marked."""

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.checks.problems import KINDS
from lsc_pose_ros.labels.checks.worst_frames import WorstFrames

STEP = 100_000_000
CAMERA = Intrinsics(100.0, 100.0, 50.0, 40.0)


def frame(number):
    positions = np.arange(60, dtype=np.float32).reshape(1, 20, 3)
    joints = np.arange(20, dtype=np.uint16)
    truth = Skeletons(np.array([1], np.uint16), joints, positions, np.ones((1, 20), np.float32))
    nothing = np.zeros((4, 4), np.float32)
    labels = np.full((4, 4), NO_BODY, np.int32)
    return Frame(number * STEP, 'camera', nothing, labels, CAMERA, truth)


def problems(**joints):
    found = {kind: np.zeros((1, 20), bool) for kind in KINDS}
    for kind, numbers in joints.items():
        found[kind][0, numbers] = True
    return found


def worst_of(badness, most=12):
    worst = WorstFrames(most)
    for number, count in enumerate(badness):
        worst.add(number, frame(number), None, problems(outside=list(range(count))), 0)
    return [each.number for each in worst.found()]


def test_frames_of_half_a_second_are_one():
    assert worst_of([0, 3, 5, 4, 0, 2, 1, 5, 2, 0]) == [2, 7]
    assert worst_of([3, 3, 3, 3, 3, 3]) == [0, 5]


def test_a_worse_frame_replaces_those_around_it():
    assert worst_of([2, 0, 0, 0, 0, 2, 0, 3]) == [7, 0]
    assert worst_of([1, 2, 3, 4, 5, 6, 7]) == [6]


def test_at_most_so_many_are_kept():
    assert worst_of([1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 2], most=2) == [5, 10]


def test_frames_without_problems_are_none():
    assert worst_of([0, 0]) == []


def test_words_and_marked_joints():
    worst = WorstFrames(3)
    found = problems(deep=[4], outside=[0, 4])
    worst.add(37, frame(37), None, found, 0)
    (only,) = worst.found()
    assert only.reasons == '2 joints off the mask, 1 joint too deep'
    np.testing.assert_array_equal(only.marked, frame(37).ground_truth.positions[0, [0, 4]])
    worst.add(47, frame(47), None, problems(), 1)
    assert [each.reasons for each in worst.found()] == ['left and right exchanged', only.reasons]
