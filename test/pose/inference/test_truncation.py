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

"""The factor for the confidence in joints near the edge of the image."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.inference.truncation import cut_sides, truncation_factor
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import cut_out

CAMERA = Intrinsics(280.0, 250.0, 31.0, 22.0)
HEIGHT, WIDTH = 40, 60


def window_of(rows: slice, columns: slice) -> Window:
    depth = np.zeros((HEIGHT, WIDTH), np.float32)
    depth[rows, columns] = 2.0
    window = cut_out(depth, np.zeros(depth.shape, np.int32), 0)
    assert window is not None
    return window


def factor_twin(joint: np.ndarray, sides: str) -> float:
    """The factor by the distance, at the joint's depth, to the nearest of the image's `sides`."""
    x, y, z = (float(number) for number in joint)
    column, row = CAMERA.cx + CAMERA.fx * x / z, CAMERA.cy + CAMERA.fy * y / z
    distances = {
        't': (row + 0.5) * z / CAMERA.fy,
        'b': (HEIGHT - 0.5 - row) * z / CAMERA.fy,
        'l': (column + 0.5) * z / CAMERA.fx,
        'r': (WIDTH - 0.5 - column) * z / CAMERA.fx,
    }
    metres = min(distances[side] for side in sides)
    if metres <= 0.05:
        return 0.2
    if metres <= 0.25:
        return 0.2 + 0.3 * (metres - 0.05) / 0.2
    return min(1.0, 0.5 + 0.5 * (metres - 0.25) / 0.65)


@pytest.mark.parametrize(
    ('rows', 'columns', 'sides'),
    [
        (slice(0, 20), slice(10, 30), 't'),
        (slice(10, HEIGHT), slice(10, 30), 'b'),
        (slice(10, 30), slice(0, 30), 'l'),
        (slice(10, 30), slice(30, WIDTH), 'r'),
        (slice(0, HEIGHT), slice(0, WIDTH), 'tblr'),
        (slice(1, HEIGHT - 1), slice(20, WIDTH), 'r'),
    ],
)
def test_confidence_decreases_towards_a_cut(rows: slice, columns: slice, sides: str) -> None:
    window = window_of(rows, columns)
    assert cut_sides(window).tolist() == [side in sides for side in 'tblr']
    joints = np.random.default_rng(0).uniform((-1, -1, 1), (1, 1, 4), (200, 3)).astype(np.float32)
    found = truncation_factor(joints, window, CAMERA)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, [factor_twin(each, sides) for each in joints], atol=1e-4)
    assert found.min() == pytest.approx(0.2)
    assert found.max() > 0.4


def test_confidence_of_a_body_that_is_not_cut_off_is_unchanged() -> None:
    window = window_of(slice(1, HEIGHT - 1), slice(1, WIDTH - 1))
    assert not cut_sides(window).any()
    joints = np.random.default_rng(1).uniform((-9, -9, 1), (9, 9, 4), (50, 3)).astype(np.float32)
    assert (truncation_factor(joints, window, CAMERA) == 1).all()


def test_joint_that_is_not_estimated_has_factor_1() -> None:
    joints = np.full((2, 3), np.nan, np.float32)
    joints[1] = (0.0, 5.0, 2.0)
    window = window_of(slice(10, HEIGHT), slice(10, 30))
    np.testing.assert_allclose(truncation_factor(joints, window, CAMERA), [1, 0.2])


def test_confidence_falls_where_the_image_ends_at_the_hips(small_model, people) -> None:
    """The same body in an image that continues below it and in one that ends there."""
    frame, estimator = people[5], Estimator(small_model)
    rows = np.flatnonzero((frame.labels >= 0).any(axis=1))
    end = int(rows[0] + 0.6 * len(rows))
    labels = frame.labels.copy()
    labels[end:] = NO_BODY
    whole = estimator.estimate(frame.depth, labels, frame.camera)
    cut = estimator.estimate(
        np.ascontiguousarray(frame.depth[:end]),
        np.ascontiguousarray(labels[:end]),
        frame.camera,
    )
    assert np.isfinite(cut.positions).all()
    knee = names_of(small_model.joints).index('l_knee')
    assert cut.confidence[0, knee] < 0.5 * whole.confidence[0, knee]
