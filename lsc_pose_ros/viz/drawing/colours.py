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

"""The colours of all figures; colour-blind people can distinguish them (Okabe and Ito)."""

LEFT = '#0072b2'
RIGHT = '#d55e00'
MIDDLE = '#1a1a1a'
GROUND_TRUTH = '#f5c400'
EDGE = '#009e73'
ACCENT = '#cc79a7'
BORDER = '#c8c8c8'
FAINT = '#8c8c8c'

# Colours of curves in their order; each curve also has its own line style.
CURVES = ('#1a1a1a', '#e69f00', '#56b4e9', '#009e73', '#cc79a7')

SEQUENTIAL = 'cividis'
FILLING = 'Greens'
DIVERGING = 'PuOr'


def side_colour(name: str) -> str:
    """Return the colour of the joint `name`: that of the person's left, right, or middle."""
    if name.startswith('l_'):
        return LEFT
    return RIGHT if name.startswith('r_') else MIDDLE


def bone_colour(parent: str, child: str) -> str:
    """Return the colour of the bone between two joints; MIDDLE if it joins left and right."""
    sides = {side_colour(parent), side_colour(child)} - {MIDDLE}
    return sides.pop() if len(sides) == 1 else MIDDLE
