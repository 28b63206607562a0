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

"""Figures as PNG files, independent of user settings."""

import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.viz.drawing.canvas import (
    house_style,
    make_directory,
    new_figure,
    png_bytes,
    save_png,
)


@house_style()
def picture() -> bytes:
    figure = new_figure(2, 1.5)
    axes = figure.subplots()
    axes.plot([0, 1], [1, 0], label='line')
    axes.set_title('a title')
    axes.legend()
    return png_bytes(figure)


def test_same_figure_gives_the_same_file_with_any_user_style() -> None:
    first = picture()
    with mpl.rc_context({'font.size': 23, 'axes.facecolor': 'red', 'savefig.dpi': 33}):
        assert picture() == first
        assert mpl.rcParams['font.size'] == 23


def test_file_names_no_program_and_no_time(tmp_path: Path) -> None:
    path = tmp_path / 'a.png'
    path.write_bytes(picture())
    with Image.open(path) as image:
        assert image.info.keys() <= {'dpi'}


def test_scale_increases_the_resolution(tmp_path: Path) -> None:
    sizes = []
    for scale in (1.0, 2.0):
        path = tmp_path / f'{scale}.png'
        path.write_bytes(png_bytes(new_figure(2, 1), scale=scale))
        with Image.open(path) as image:
            sizes.append(image.size)
    assert sizes == [(200, 100), (400, 200)]


def test_saving_leaves_only_the_file(tmp_path: Path) -> None:
    save_png(new_figure(1, 1), tmp_path / 'a.png')
    assert [path.name for path in tmp_path.iterdir()] == ['a.png']
    with Image.open(tmp_path / 'a.png') as image:
        assert np.asarray(image.convert('L')).min() == 255


def test_what_cannot_be_written_names_the_file_and_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / 'taken').mkdir()
    with pytest.raises(InputError, match='taken is a folder'):
        save_png(new_figure(1, 1), tmp_path / 'taken')
    assert [path.name for path in tmp_path.iterdir()] == ['taken']


def test_error_names_a_folder_that_cannot_be_created(tmp_path: Path) -> None:
    (tmp_path / 'file').touch()
    with pytest.raises(InputError, match=r'file/below: cannot create this folder'):
        make_directory(tmp_path / 'file' / 'below')


def test_drawing_needs_neither_pyplot_nor_a_display() -> None:
    script = (
        'import sys\n'
        'import lsc_pose_ros.viz.report.report, lsc_pose_ros.viz.stages.stage_sheet\n'
        'sys.exit("matplotlib.pyplot" in sys.modules)\n'
    )
    root = Path(__file__).parents[3]
    assert subprocess.run([sys.executable, '-c', script], cwd=root, check=False).returncode == 0
