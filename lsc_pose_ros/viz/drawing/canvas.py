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

"""Figures without a window and independent of the user's settings, and writing them as PNG."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import PNG
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.colours import FAINT, MIDDLE, PAGE

DOTS_PER_INCH = 100

CHART_WIDTH = 3.6
"""The width of a chart on a page, inches: that of the text on a phone."""

_STYLE = {
    'font.size': 9,
    'axes.titlesize': 9,
    'axes.labelsize': 9,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.edgecolor': FAINT,
    'axes.labelcolor': MIDDLE,
    'axes.titlecolor': MIDDLE,
    'text.color': MIDDLE,
    'axes.linewidth': 0.8,
    'axes.grid': False,
    'xtick.labelsize': 8,
    'ytick.labelsize': 8,
    'xtick.color': FAINT,
    'ytick.color': FAINT,
    'legend.fontsize': 8,
    'legend.frameon': False,
    'image.interpolation': 'nearest',
    # Words of an SVG remain words, and the same figure gives the same file.
    'svg.fonttype': 'none',
    'svg.hashsalt': 'lsc_pose_ros',
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw the same on every machine, independent of its matplotlibrc; also a decorator."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)  # type: ignore[arg-type]
        yield


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of `width` x `height` inches, drawn without a display."""
    figure = Figure(
        figsize=(width, height), dpi=DOTS_PER_INCH, layout='constrained', facecolor=PAGE
    )
    FigureCanvasAgg(figure)
    return figure


def hide_axes(axes: Axes) -> None:
    """Hide ticks and spines of `axes`."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)


@house_style()
def png_bytes(figure: Figure, *, scale: float = 1.0) -> bytes:
    """Return `figure` as the bytes of a PNG file, with `scale` times DOTS_PER_INCH."""
    buffer = io.BytesIO()
    figure.savefig(
        buffer,
        format='png',
        dpi=scale * DOTS_PER_INCH,
        # Without the program's version, the same figure gives the same file.
        metadata={'Software': None},
        pil_kwargs={'optimize': True},
    )
    return buffer.getvalue()


def save_png(figure: Figure, path: Path) -> None:
    """Write `figure` to `path`, `-` for standard output.

    Raises:
        InputError: the file cannot be written.
    """
    write_output(path, PNG, png_bytes(figure))


def make_directory(directory: Path) -> None:
    """Make `directory` if it does not exist.

    Raises:
        InputError: it cannot be made.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        msg = f'{directory}: cannot create this folder: {error.strerror or error}'
        raise InputError(msg) from error
