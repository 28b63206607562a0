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


"""What the program that counts found people counts."""

import sys
from pathlib import Path

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'models'))

import found_people
from found_people import Found, compare, total

CAMERA = Intrinsics(100.0, 100.0, 50.0, 50.0)


def numbered(*rectangles: tuple[int, int, int, int, int]) -> np.ndarray:
    """Return labels with rectangles: number, first and last row, first and last column."""
    labels = np.full((100, 100), NO_BODY, np.int32)
    for number, top, bottom, left, right in rectangles:
        labels[top:bottom, left:right] = number
    return labels


def counted(labels: np.ndarray, truth: np.ndarray, z: float = 2.0) -> Found:
    return compare(labels, truth, np.full((100, 100), z, np.float32), CAMERA)


TRUTH = numbered((1, 10, 90, 10, 30), (2, 10, 90, 60, 80))


def test_a_person_is_found_by_half_of_the_union() -> None:
    assert counted(numbered((7, 10, 90, 10, 30)), TRUTH) == Found(1, 2, 1, 0)
    assert counted(numbered((7, 10, 50, 10, 30)), TRUTH) == Found(1, 2, 1, 0)
    assert counted(numbered((7, 10, 49, 10, 30)), TRUTH) == Found(1, 2, 0, 0)


def test_a_body_beside_people_is_false() -> None:
    assert counted(numbered((1, 10, 90, 10, 30), (2, 10, 90, 35, 55)), TRUTH) == Found(1, 2, 1, 1)
    assert counted(numbered((1, 10, 90, 20, 41)), TRUTH) == Found(1, 2, 0, 1)


def test_two_people_in_one_body_are_not_found() -> None:
    assert counted(numbered((1, 10, 90, 10, 80)), TRUTH) == Found(1, 2, 0, 0)


def test_people_who_are_hardly_seen_or_far_away_do_not_count() -> None:
    small = numbered((1, 10, 26, 10, 28))  # 288 pixels of 4 square centimetres
    nobody = numbered()
    assert counted(nobody, small) == Found(1, 0, 0, 0)
    assert counted(nobody, TRUTH, 6.0) == Found(1, 0, 0, 0)
    assert counted(nobody, TRUTH) == Found(1, 2, 0, 0)


def test_totals_are_sums() -> None:
    assert total([Found(1, 2, 1, 0), Found(1, 3, 3, 2)]) == Found(2, 5, 4, 2)


def test_the_program_measures_each_camera(monkeypatch, capsys) -> None:
    monkeypatch.setattr(found_people, 'FRAMES_OF_PEOPLE', ((0, 1), (1, 1)))
    monkeypatch.setattr(found_people, 'SENSORS', ('kinect_v1', 'tof'))
    assert found_people.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:3]] == ['kinect_v1', 'tof', 'all']
    assert 'in 4 frames' in lines[2]
