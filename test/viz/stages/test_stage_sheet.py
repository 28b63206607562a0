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

"""The panels and figures of the stages."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.canvas import png_bytes
from lsc_pose_ros.viz.stages.shown_body import ShownBody, show_body
from lsc_pose_ros.viz.stages.stage_numbers import stage_numbers
from lsc_pose_ros.viz.stages.stage_sheet import stage_panels, stage_sheet, write_stages

WITHOUT_MODEL = ['1_depth', '2_smoothing', '3_silhouette', '4_descriptor']
WITH_MODEL = ['5_votes', '6_densities', '7_pairs', '8_skeleton']


@pytest.mark.parametrize('feature', ['2dsc', 'dcf'])
def test_sentence_replaces_the_figure_of_another_feature(
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


def test_every_stage_is_written(shown: ShownBody, tmp_path: Path) -> None:
    *paths, numbers = write_stages(tmp_path / 'new' / 'folder', shown)
    assert json.loads(numbers.read_text()) == json.loads(json.dumps(stage_numbers(shown)))
    assert [path.stem for path in paths] == [*WITHOUT_MODEL, *WITH_MODEL, 'stages']
    assert {path.name for path in (*paths, numbers)} == {
        path.name for path in paths[0].parent.iterdir()
    }
    for path in paths:
        with Image.open(path) as image:
            assert np.asarray(image.convert('L')).std() > 5, path.name


def test_without_a_model_the_first_stages_are_drawn(people: list[Frame]) -> None:
    shown = show_body('frame 0', people[0])
    assert [stage.name for stage in stage_panels(shown)] == WITHOUT_MODEL
    with Image.open(io.BytesIO(png_bytes(stage_sheet(shown)))) as image:
        assert image.width > image.height


def test_sheet_numbers_the_stages_and_has_the_error(shown: ShownBody) -> None:
    titles = [axes.get_title() for axes in stage_sheet(shown).axes]
    numbered = [title for title in titles if title]
    assert [title.partition('.')[0] for title in numbered] == list('12345678')
    assert numbered[-1].endswith('cm')


def test_frame_without_ground_truth_has_stages_too(shown: ShownBody, people: list[Frame]) -> None:
    assert shown.model is not None
    blind = show_body('frame 0', people[0]._replace(ground_truth=None), 1, shown.model)
    assert np.isnan(blind.ground_truth(shown.model.joints)).all()
    titles = [axes.get_title() for axes in stage_sheet(blind).axes]
    assert '8. joints' in titles
