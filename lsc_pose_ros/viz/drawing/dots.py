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

"""Dots: markers at positions in axes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lsc_pose_ros.viz.drawing.colours import MIDDLE


class Dot(NamedTuple):
    """The look of dots.

    Attributes:
        size: the area, points squared.
        colour: one colour for all, or one for each.
        rim: the colour of the rim, 'none' for none.
        rim_width: points.
        marker: the shape, a matplotlib marker.
        layer: dots in higher layers hide those in lower ones.
    """

    size: float
    colour: str | Sequence[str]
    rim: str = 'none'
    rim_width: float = 0.7
    marker: str = 'o'
    layer: float = 2.0


RING = Dot(70, 'none', rim=MIDDLE, rim_width=1.6, layer=8)
"""A circle around a joint."""


def draw_dots(
    axes: Axes,
    positions: NDArray[np.floating] | NDArray[np.integer],
    dot: Dot,
    opacity: NDArray[np.floating] | None = None,
) -> None:
    """Draw a dot at each position.

    Args:
        axes: the axes.
        positions: x and y, NaN for no dot, shape (n, 2).
        dot: the look.
        opacity: of each dot, from 0, invisible, to 1, shape (n,).
    """
    axes.scatter(
        x=positions[:, 0],
        y=positions[:, 1],
        s=dot.size,
        c=dot.colour,
        edgecolors=dot.rim,
        linewidths=0 if dot.rim == 'none' else dot.rim_width,
        marker=dot.marker,
        alpha=opacity,  # type: ignore[arg-type]  # the stubs allow only one number
        zorder=dot.layer,
    )
