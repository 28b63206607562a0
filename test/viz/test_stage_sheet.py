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

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from plain.density import density
from plain.descriptor import describe

from lsc_pose_ros.data_types.camera import Intrinsics, back_project
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.features.shape_context_3d import AZIMUTH_BINS, RADIUS_BINS, ZENITH_BINS
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.canvas import png_bytes
from lsc_pose_ros.viz.stages.density_figure import line_integral
from lsc_pose_ros.viz.stages.descriptor_figure import bin_radii, shown_point
from lsc_pose_ros.viz.stages.shown_body import ShownBody, show_body
from lsc_pose_ros.viz.stages.stage_sheet import stage_panels, stage_sheet, write_stages
from lsc_pose_ros.viz.stages.vote_panels import positions_and_weights

WITHOUT_MODEL = ['1_depth', '2_smoothing', '3_silhouette', '4_descriptor']
WITH_MODEL = ['5_votes', '6_densities', '7_pairs', '8_skeleton']


@pytest.fixture(scope='module')
def shown(people: list[Frame], model: Model) -> ShownBody:
    return show_body('frame 0', people[0], 1, model)


def test_line_integral_is_the_density_summed_along_the_ray() -> None:
    rng = np.random.default_rng(3)
    camera = Intrinsics(90.0, 110.0, 40.0, 30.0)
    places = rng.normal([0.1, -0.1, 2.5], 0.15, (20, 3)).astype(np.float32)
    weights = rng.random(20).astype(np.float32)
    step = 0.002
    for column, row in ((44.0, 26.0), (20.0, 50.0)):
        ray = back_project(np.array(column), np.array(row), np.array(1.0), camera)
        ray = ray / np.linalg.norm(ray)
        along = np.arange(1, 4, step)[:, None] * ray
        summed = step * sum(
            density(place.astype(np.float32), places, weights, 0.07) for place in along
        )
        found = line_integral(places, weights, np.array([column, row]), camera, 0.07)
        assert found == pytest.approx(summed, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize('radius_bin', range(RADIUS_BINS))
def test_bin_radii_are_where_the_descriptors_bins_end(radius_bin: int) -> None:
    radii = bin_radii(0.8, 0.1)
    assert radii[[0, -1]] == pytest.approx([0.08, 0.8])
    middle = np.sqrt(radii[radius_bin] * radii[radius_bin + 1])
    points = np.array([[0, 0, 2], [middle, 0, 2]], np.float32)
    histogram = describe(points, np.arange(1), 0.8, 0.1)[0]
    filled = histogram.reshape(RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS)
    assert filled.sum(axis=(1, 2))[radius_bin] == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize('feature', ['2dsc', 'dcf'])
def test_a_rivals_feature_is_not_drawn_and_that_is_said(
    feature: str, people: list[Frame], model: Model
) -> None:
    settings = model.settings._replace(feature=feature, sample='body')
    shown = show_body('frame 0', people[0], 1, model._replace(settings=settings))
    stages = stage_panels(shown)
    assert [stage.name for stage in stages] == WITHOUT_MODEL + WITH_MODEL
    assert stages[3].figure is None
    axes = stage_sheet(shown).axes[3]
    said = ' '.join(text.get_text() for text in axes.texts).split()
    assert ' '.join(said) == (
        f'The feature of this model, {feature}, is not drawn; only that of the paper, 3dlsc, is.'
    )


def test_the_shown_descriptor_is_that_of_an_outermost_point(shown: ShownBody) -> None:
    x = shown.result.silhouette.points[:, 0]
    assert x[shown_point(shown)] in (x.min(), x.max())


def test_votes_for_takes_those_of_one_target(shown: ShownBody) -> None:
    assert shown.model is not None
    votes = shown.result.joint_votes
    parts = [positions_and_weights(votes, joint) for joint in range(len(votes.start) - 1)]
    np.testing.assert_array_equal(np.concatenate([places for places, _ in parts]), votes.position)
    np.testing.assert_array_equal(np.concatenate([part[1] for part in parts]), votes.weight)


def test_every_stage_is_written(shown: ShownBody, tmp_path: Path) -> None:
    paths = write_stages(tmp_path / 'new' / 'folder', shown)
    assert [path.stem for path in paths] == [*WITHOUT_MODEL, *WITH_MODEL, 'stages']
    assert {path.name for path in paths} == {path.name for path in paths[0].parent.iterdir()}
    for path in paths:
        with Image.open(path) as image:
            assert np.asarray(image.convert('L')).std() > 5, path.name


def test_without_a_model_the_first_stages_are_drawn(people: list[Frame]) -> None:
    shown = show_body('frame 0', people[0])
    assert [stage.name for stage in stage_panels(shown)] == WITHOUT_MODEL
    with Image.open(io.BytesIO(png_bytes(stage_sheet(shown)))) as image:
        assert image.width > image.height


def test_the_sheet_numbers_the_stages_and_tells_the_error(shown: ShownBody) -> None:
    titles = [axes.get_title() for axes in stage_sheet(shown).axes]
    numbered = [title for title in titles if title]
    assert [title.partition('.')[0] for title in numbered] == list('12345678')
    assert numbered[-1].endswith('cm')


def test_a_frame_without_ground_truth_has_stages_too(
    shown: ShownBody, people: list[Frame]
) -> None:
    assert shown.model is not None
    blind = show_body('frame 0', people[0]._replace(ground_truth=None), 1, shown.model)
    assert np.isnan(blind.ground_truth(shown.model.joints)).all()
    titles = [axes.get_title() for axes in stage_sheet(blind).axes]
    assert '8. joints' in titles


def test_the_body_that_covers_the_most_pixels_is_chosen(people: list[Frame]) -> None:
    labels = people[0].labels.copy()
    labels[:3, :3] = 0
    assert show_body('frame 0', people[0]._replace(labels=labels)).number == 1


def test_a_body_that_is_not_there_is_named_with_those_that_are(people: list[Frame]) -> None:
    with pytest.raises(InputError, match=r'frame 0: the mask has no body 5; the bodies in it: 1$'):
        show_body('frame 0', people[0], 5)


def test_an_empty_mask_is_refused(people: list[Frame]) -> None:
    empty = people[0]._replace(labels=np.full_like(people[0].labels, -1))
    with pytest.raises(InputError, match='frame 4: the mask shows nobody'):
        show_body('frame 4', empty)


@pytest.mark.parametrize('with_model', [False, True])
def test_a_speck_is_refused(people: list[Frame], model: Model, with_model: bool) -> None:  # noqa: FBT001
    labels = np.full_like(people[0].labels, -1)
    rows, columns = np.nonzero(people[0].labels == 1)
    labels[rows[:4], columns[:4]] = 1
    with pytest.raises(InputError, match='frame 0: too little of body 1 is visible'):
        show_body('frame 0', people[0]._replace(labels=labels), 1, model if with_model else None)
