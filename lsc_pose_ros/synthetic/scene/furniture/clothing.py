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

"""Clothes and bags that nobody wears."""

import numpy as np

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder
from lsc_pose_ros.synthetic.scene.shapes import bar_axes, loft, rounded


def coat(stream: RandomStream) -> Piece:
    """Return a hanging coat with sleeves; its lowest point is at y = 0."""
    builder = PieceBuilder()
    length, shoulders = stream.between(0.55, 1.15), stream.between(0.15, 0.24)
    deep, hem = stream.between(0.05, 0.13), stream.between(0.8, 1.3)
    heights = length * np.array([0.0, 0.3, 0.6, 0.85, 0.95, 1.0])
    widths = shoulders * np.array([hem, 0.5 * (1 + hem), 0.95, 1.0, 0.75, 0.25])
    depths = deep * np.array([1.1, 1.2, 1.1, 1.0, 0.8, 0.3])
    builder.shape(loft(heights, widths, depths, exponent=0.7), (0.0, 0.0, 0.0))
    sleeve = min(stream.between(0.45, 0.65), 0.8 * length)
    for side in (-1.0, 1.0):
        top = np.array([side * 0.95 * shoulders, 0.88 * length, 0.0])
        end = top + np.array(
            [side * stream.between(0.02, 0.12), -sleeve, stream.between(-0.04, 0.06)]
        )
        arm = loft((0.0, 0.5 * sleeve, sleeve), (0.065, 0.06, 0.055), (0.06, 0.055, 0.05), sides=8)
        builder.shape(arm, top, bar_axes(top, end))
    return builder.build()


def bag(stream: RandomStream) -> Piece:
    """Return a bag or a backpack with a strap; its lowest point is at y = 0."""
    builder = PieceBuilder()
    half = np.array([stream.between(0.1, 0.22), stream.between(0.12, 0.28), 0.1])
    half[2] = stream.between(0.05, 0.12)
    builder.shape(rounded(half, 0.4), (0.0, half[1], 0.0))
    strap = 2 * half[1] + stream.between(0.1, 0.4)
    for side in (-0.6, 0.6):
        builder.bar((side * half[0], 1.8 * half[1], 0.0), (0.0, strap, 0.0), 0.03, 0.01)
    return builder.build()


def coat_stand(stream: RandomStream) -> Piece:
    """Return a coat stand with coats, bags and sometimes a hat."""
    builder = PieceBuilder()
    height = stream.between(1.5, 1.9)
    builder.post((0.0, 0.0, 0.0), height, 0.025)
    builder.post((0.0, 0.0, 0.0), 0.04, 0.2)
    for x, z in ((0.14, 0.0), (-0.14, 0.0), (0.0, 0.14))[: int(stream.between(1, 4))]:
        thing = coat(stream) if stream.bernoulli(0.75) else bag(stream)
        top = thing.size()[1][1]
        builder.add(thing, (x, height - 0.1 - top, z))
    if stream.bernoulli(0.4):
        builder.cushion((0.0, height + 0.05, 0.0), (0.28, 0.16, 0.28), 1.0)
    return builder.build()


def dummy(stream: RandomStream) -> Piece:
    """Return a tailor's dummy: a trunk on a stand."""
    builder = PieceBuilder()
    leg, width = stream.between(0.6, 0.9), stream.between(0.15, 0.21)
    heights = leg + np.array([0.0, 0.15, 0.3, 0.48, 0.58, 0.62, 0.7])
    widths = width * np.array([1.0, 0.95, 0.75, 1.0, 0.95, 0.4, 0.35])
    depths = width * np.array([0.65, 0.65, 0.5, 0.65, 0.5, 0.35, 0.3])
    builder.shape(loft(heights, widths, depths), (0.0, 0.0, 0.0))
    builder.post((0.0, 0.0, 0.0), leg, 0.02)
    builder.post((0.0, 0.0, 0.0), 0.03, 0.18)
    return builder.build()
