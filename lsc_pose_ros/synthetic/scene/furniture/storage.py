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

"""Pieces that stand or hang at walls: shelves, cupboards, curtains, doors, coats on hooks."""

import numpy as np

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.furniture.clothing import bag, coat
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder
from lsc_pose_ros.synthetic.scene.shapes import sheet

_RODS = np.arange(49)


def shelf(stream: RandomStream) -> Piece:
    """Return a shelf, open or with a back, with boxes and books on its boards."""
    builder = PieceBuilder()
    width, depth = stream.between(0.5, 1.6), stream.between(0.22, 0.45)
    height, count = stream.between(0.8, 2.1), int(stream.between(3, 6))
    thickness = stream.between(0.02, 0.04)
    for side in (-0.5, 0.5):
        builder.box((side * width, 0.5 * height, 0.0), (thickness, height, depth))
    if stream.bernoulli(0.6):
        builder.box((0.0, 0.5 * height, -0.5 * depth), (width, height, 0.02))
    gap = height / count
    for board in range(count + 1):
        builder.box((0.0, board * gap, 0.0), (width, thickness, depth))
    for board in range(count):
        for _ in range(2):
            size = (stream.between(0.1, 0.5) * width, stream.between(0.3, 0.9) * gap, 0.8 * depth)
            x = (stream.uniform() - 0.5) * (width - size[0])
            if stream.bernoulli(0.8):
                builder.box((x, board * gap + 0.5 * size[1], 0.0), size)
    return builder.build()


def cupboard(stream: RandomStream) -> Piece:
    """Return a cupboard, chest of drawers, wardrobe or refrigerator."""
    builder = PieceBuilder()
    width, depth = stream.between(0.4, 1.8), stream.between(0.35, 0.65)
    height = stream.between(0.7, 2.1)
    builder.box((0.0, 0.5 * height, 0.0), (width, height, depth))
    front, doors = 0.5 * depth, int(stream.between(1, 4))
    drawn = stream.between(0.005, 0.03)
    for door in range(doors):  # doors or drawers protrude a little, with gaps between them
        x = ((door + 0.5) / doors - 0.5) * width
        builder.box((x, 0.5 * height, front), (width / doors - 0.03, 0.9 * height, 2 * drawn))
        builder.box((x, 0.55 * height, front + 0.04), (0.03, 0.15, 0.03))
    if stream.bernoulli(0.3):
        builder.box((0.0, height + 0.15, 0.0), (0.6 * width, 0.3, 0.7 * depth))
    return builder.build()


def curtain(stream: RandomStream) -> Piece:
    """Return a curtain, which hangs in waves that are gathered towards its top."""
    width, height = stream.between(0.5, 2.2), stream.between(1.4, 2.5)
    deep, waves = stream.between(0.03, 0.12), stream.between(4, 10) * width
    phase, other = stream.uniform(), stream.uniform()
    along = _RODS / (len(_RODS) - 1)
    wave = np.sin(2 * np.pi * (waves * along + phase)) + 0.6 * np.sin(
        2 * np.pi * (0.37 * waves * along + other)
    )
    fall = np.linspace(1.0, stream.between(0.3, 1.0), 8)
    builder = PieceBuilder()
    base = stream.between(0.0, 0.8)
    builder.shape(sheet(deep * np.outer(fall, wave), width, height), (0.0, base, 0.0))
    builder.bar((-0.6 * width, base + height, 0.0), (0.6 * width, base + height, 0.0), 0.03)
    return builder.build()


def door(stream: RandomStream) -> Piece:
    """Return a door frame, sometimes with a leaf that is ajar."""
    builder = PieceBuilder()
    width, height = stream.between(0.75, 1.0), stream.between(1.95, 2.1)
    post, deep = stream.between(0.06, 0.15), stream.between(0.05, 0.3)
    for side in (-0.5, 0.5):
        builder.box((side * (width + post), 0.5 * height, 0.0), (post, height, deep))
    builder.box((0.0, height + 0.5 * post, 0.0), (width + 2 * post, post, deep))
    kind = stream.uniform()
    if kind < 0.35:
        builder.box((0.0, 0.5 * height, -0.3 * deep), (width, height, 0.04))
    elif kind < 0.75:
        angle = stream.between(0.3, 1.8)
        x, z = width * np.cos(angle), width * np.sin(angle)
        hinge = -0.5 * width
        builder.bar((hinge, 0.5 * height, 0.0), (hinge + x, 0.5 * height, z), 0.04, height - 0.02)
    return builder.build()


def hooks(stream: RandomStream) -> Piece:
    """Return a row of hooks with coats and bags; a coat resembles a trunk without a head."""
    builder = PieceBuilder()
    height, count = stream.between(1.35, 1.85), int(stream.between(1, 5))
    builder.box((0.0, height, 0.0), (0.4 * count, 0.1, 0.03))
    for number in range(count):
        x = 0.4 * (number - 0.5 * (count - 1))
        thing = coat(stream) if stream.bernoulli(0.65) else bag(stream)
        top = thing.size()[1][1]
        builder.add(thing, (x, height - top, 0.15))
    return builder.build()


def wall_things(stream: RandomStream) -> Piece:
    """Return something flat on a wall: a picture, a board, a screen or a radiator."""
    builder = PieceBuilder()
    width, height = stream.between(0.3, 1.5), stream.between(0.3, 1.0)
    low = stream.between(0.1, 1.3)
    builder.box((0.0, low + 0.5 * height, 0.0), (width, height, stream.between(0.03, 0.2)))
    return builder.build()
