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

"""Tables, desks and counters, and what stands on them."""

from typing import NamedTuple

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder


class TableSize(NamedTuple):
    """The size of a table or counter, metres."""

    width: float
    depth: float
    height: float


def sample_table(stream: RandomStream) -> TableSize:
    """Sample the size of a table: from a coffee table to a standing desk."""
    height = stream.choose(((0.2, 0.45), (0.65, 0.74), (0.15, 1.0))) + stream.between(-0.06, 0.06)
    return TableSize(stream.between(0.6, 2.0), stream.between(0.45, 0.95), height)


def table(size: TableSize, stream: RandomStream) -> Piece:
    """Return a table with legs, a column or panels, and some things on it."""
    builder = PieceBuilder()
    plate = stream.between(0.02, 0.06)
    under = size.height - plate
    builder.box((0.0, size.height - 0.5 * plate, 0.0), (size.width, plate, size.depth))
    support = stream.choose(((0.55, 'legs'), (0.15, 'column'), (0.3, 'panels')))
    leg = stream.between(0.03, 0.08)
    x, z = 0.5 * size.width - leg, 0.5 * size.depth - leg
    if support == 'legs':
        for side in (-x, x):
            builder.bar((side, 0.0, z), (side, under, z), leg)
            builder.bar((side, 0.0, -z), (side, under, -z), leg)
    elif support == 'column':
        builder.post((0.0, 0.0, 0.0), under, leg)
        builder.post((0.0, 0.0, 0.0), 0.04, 0.35 * size.depth)
    else:
        for side in (-x, x):
            builder.box((side, 0.5 * under, 0.0), (0.03, under, size.depth))
    add_things(builder, size, stream)
    return builder.build()


def desk(size: TableSize, stream: RandomStream) -> Piece:
    """Return a desk whose user is in front of it, with a panel at the far side and monitors."""
    builder = PieceBuilder()
    builder.add(table(size._replace(depth=max(size.depth, 0.55)), stream), (0.0, 0.0, 0.0))
    if stream.bernoulli(0.5):
        low = stream.between(0.05, 0.35)
        builder.box(
            (0.0, 0.5 * (size.height + low), -0.5 * size.depth),
            (size.width, size.height - low, 0.02),
        )
    if stream.bernoulli(0.5):  # drawers
        side = 0.5 * size.width - 0.22
        under = size.height - 0.07
        builder.box((side, 0.5 * under, -0.05), (0.4, under, 0.8 * size.depth))
    count = stream.choose(((0.4, 1), (0.35, 2), (0.25, 0)))
    wide, high = stream.between(0.4, 0.65), stream.between(0.25, 0.4)
    for number in range(count):
        x = (number - 0.5 * (count - 1)) * (wide + 0.03)
        behind = -0.3 * size.depth
        builder.box((x, size.height + 0.12 + 0.5 * high, behind), (wide, high, 0.04))
        builder.bar((x, size.height, behind - 0.05), (x, size.height + 0.25, behind - 0.03), 0.05)
    return builder.build()


def counter(size: TableSize, stream: RandomStream) -> Piece:
    """Return a counter, a sideboard or a low wall, closed down to the floor."""
    builder = PieceBuilder()
    over = stream.between(0.0, 0.12)
    plate = stream.between(0.02, 0.06)
    builder.box((0.0, size.height - 0.5 * plate, 0.0), (size.width, plate, size.depth))
    builder.box(
        (0.0, 0.5 * (size.height - plate), -0.5 * over),
        (size.width - 0.02, size.height - plate, size.depth - over),
    )
    if stream.bernoulli(0.5):
        add_things(builder, size, stream)
    return builder.build()


def add_things(builder: PieceBuilder, size: TableSize, stream: RandomStream) -> None:
    """Add up to four boxes, bottles, bowls or heaps that stand on a surface."""
    for _ in range(int(stream.between(0, 5))):
        x = (stream.uniform() - 0.5) * (size.width - 0.3)
        z = (stream.uniform() - 0.5) * (size.depth - 0.2)
        width, height = stream.between(0.06, 0.35), stream.between(0.03, 0.35)
        kind = stream.uniform()
        if kind < 0.45:
            builder.box((x, size.height + 0.5 * height, z), (width, height, 0.7 * width))
        elif kind < 0.8:
            builder.post((x, size.height, z), height, 0.25 * width, 0.2 * width)
        else:
            builder.cushion((x, size.height + 0.4 * height, z), (width, height, width), 0.8)
