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

"""The colours of all figures and pages; colour-blind people can distinguish them.

Each has a shade for white paper and one for a dark page. The sides and the silhouette have the
colours of Okabe and Ito. Curves have none of the colours that mean a part of a skeleton.
"""

from typing import NamedTuple


class Shades(NamedTuple):
    """One colour on white and on a dark page."""

    light: str
    dark: str


PALETTE = {
    'page': Shades('#ffffff', '#16191d'),
    'ink': Shades('#1a1a1a', '#ececec'),
    'faint': Shades('#666666', '#a2a8b0'),
    'border': Shades('#c8c8c8', '#484f58'),
    'link': Shades('#0b5cad', '#8ab8ff'),
    'left': Shades('#0072b2', '#5aaeea'),
    'right': Shades('#d55e00', '#ee7733'),
    'truth': Shades('#f5c400', '#f0c000'),
    'edge': Shades('#009e73', '#2fc296'),
    'violet': Shades('#6a3dd0', '#8f6bff'),
    'rose': Shades('#b07aa8', '#d9a3d0'),
    'maroon': Shades('#7a1f1f', '#b8504c'),
    'grey': Shades('#7f7f7f', '#8c8c8c'),
}
"""All colours by name; pages name them as variables of CSS."""

PAGE = PALETTE['page'].light
LEFT = PALETTE['left'].light
RIGHT = PALETTE['right'].light
MIDDLE = PALETTE['ink'].light
GROUND_TRUTH = PALETTE['truth'].light
EDGE = PALETTE['edge'].light
BORDER = PALETTE['border'].light
FAINT = PALETTE['faint'].light

# Colours of curves in their order; each curve also has its own line style.
CURVES = (MIDDLE, *(PALETTE[name].light for name in ('violet', 'rose', 'maroon', 'grey')))
DASHES: tuple[tuple[float, ...], ...] = (
    (),
    (5, 1.5),
    (2, 1.2),
    (6, 1.5, 1.5, 1.5),
    (9, 2),
)

SEQUENTIAL = 'cividis'
FILLING = 'Greens'
DIVERGING = 'PuOr'


class LineLook(NamedTuple):
    """The colour of a curve, and its dashes in multiples of its width."""

    colour: str
    dashes: tuple[float, ...]

    @property
    def solid(self) -> 'LineLook':
        """The same colour without dashes, for bars."""
        return LineLook(self.colour, ())


def curve_look(number: int) -> LineLook:
    """Return the look of the curve `number`, counted from 0; after the last, they repeat."""
    return LineLook(CURVES[number % len(CURVES)], DASHES[number % len(DASHES)])


ALL_JOINTS = 'all joints'
LIMB_ENDS = ('elbows', 'wrists', 'hands')
PARTS = {part: curve_look(number) for number, part in enumerate((ALL_JOINTS, *LIMB_ENDS))}
"""The looks of the curves of parts of the body."""


def side_colour(name: str) -> str:
    """Return the colour of the joint `name`: that of the person's left, right, or middle."""
    if name.startswith('l_'):
        return LEFT
    return RIGHT if name.startswith('r_') else MIDDLE


def bone_colour(parent: str, child: str) -> str:
    """Return the colour of the bone between two joints; MIDDLE if it joins left and right."""
    sides = {side_colour(parent), side_colour(child)} - {MIDDLE}
    return sides.pop() if len(sides) == 1 else MIDDLE
