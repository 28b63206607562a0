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

"""The features by name, and their points."""

import numpy as np
import pytest

from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.features.shape_context_2d import describe_in_image
from lsc_pose_ros.pose.features.shape_context_3d import describe, mean_distance
from lsc_pose_ros.pose.settings import FEATURES, SAMPLES, Settings
from lsc_pose_ros.pose.stages import describe_body


@pytest.mark.parametrize('sample', SAMPLES)
@pytest.mark.parametrize('feature', FEATURES)
def test_every_feature_describes_every_kind_of_points(feature, sample, people):
    frame = people[5]
    settings = Settings(
        feature=feature, sample=sample, points=120, query_points=50, offset_pairs=90
    )
    shape = describe_body(frame.depth, frame.labels, frame.camera, 1, settings)
    assert feature_size(settings) == {'3dlsc': 360, '2dsc': 60, 'dcf': 90, 'mixed': 450}[feature]
    assert shape.quantised.shape == (50, feature_size(settings))
    assert shape.quantised.dtype == np.uint8
    # No two points look alike, and every feature tells something.
    assert len(np.unique(shape.quantised, axis=0)) > 45
    assert (shape.quantised.std(axis=0) > 0).mean() > 0.6


def test_papers_feature_is_the_descriptor_of_the_silhouette(people):
    frame, settings = people[5], Settings(points=120)
    shape = describe_body(frame.depth, frame.labels, frame.camera, 1, settings)
    points = shape.silhouette.points
    reach = mean_distance(points) * settings.support_radius
    expected = describe(points, np.arange(120), reach, settings.inner_radius)
    np.testing.assert_array_equal(shape.quantised, expected)


@pytest.mark.parametrize('support_radius', [0.5, 1.5])
def test_2d_shape_context_reaches_as_far_as_support_radius_says(support_radius, people):
    """The radius is `support_radius` times the mean distance of the silhouette's pixels."""
    frame, settings = people[5], Settings(feature='2dsc', support_radius=support_radius, points=80)
    body = describe_body(frame.depth, frame.labels, frame.camera, 1, settings)
    silhouette = body.silhouette
    columns, rows = (
        pixels[silhouette.chosen].astype(float) for pixels in (silhouette.columns, silhouette.rows)
    )
    pairs = np.triu_indices(80, k=1)
    mean = np.hypot(*((x[:, None] - x[None])[pairs] for x in (columns, rows))).mean()
    pixels = np.stack([columns, rows], axis=1).astype(np.float32)
    expected = describe_in_image(
        pixels, np.arange(80), support_radius * mean, settings.inner_radius
    )
    # A pixel's distance may be that of the radius, to the last bit.
    assert (body.quantised == expected).mean() > 0.99


def test_features_change_neither_the_points_nor_their_unit(people):
    frame = people[5]
    for sample in SAMPLES:
        shapes = [
            describe_body(
                frame.depth,
                frame.labels,
                frame.camera,
                1,
                Settings(feature=feature, sample=sample),
            )
            for feature in FEATURES
        ]
        for shape in shapes[1:]:
            np.testing.assert_array_equal(shape.points, shapes[0].points)
            assert shape.scale == shapes[0].scale


def test_points_of_the_body_are_spread_over_all_of_it(people):
    frame = people[5]
    body = (frame.labels == 1) & (frame.depth > 0)
    settings = Settings(sample='body', points=200)
    silhouette = describe_body(frame.depth, frame.labels, frame.camera, 1, settings).silhouette
    everything = np.zeros_like(body)
    everything[silhouette.rows, silhouette.columns] = True
    np.testing.assert_array_equal(everything, body)
    assert len(silhouette.points) == 200
    rows, columns = np.nonzero(body)
    kept = silhouette.chosen
    for all_places, positions in (
        (rows, silhouette.rows[kept]),
        (columns, silhouette.columns[kept]),
    ):
        np.testing.assert_allclose(
            np.quantile(positions, [0.1, 0.5, 0.9]),
            np.quantile(all_places, [0.1, 0.5, 0.9]),
            atol=3,
        )
