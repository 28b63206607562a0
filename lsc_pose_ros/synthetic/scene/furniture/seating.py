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

"""Pieces that people sit or lie on: chairs, stools, armchairs, sofas, boxes, beds."""

from collections.abc import Callable
from typing import NamedTuple

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder


class SeatSize(NamedTuple):
    """The surface that a person sits on. Its middle is above the piece's origin.

    Attributes:
        width: metres.
        depth: from its front edge to the back, metres.
        height: above the floor, metres.
        back: height of the back above the seat, metres; 0 if it has none.
    """

    width: float
    depth: float
    height: float
    back: float


def sample_seat(stream: RandomStream) -> SeatSize:
    """Sample the size of a seat for one person."""
    return SeatSize(
        stream.between(0.36, 0.52),
        stream.between(0.36, 0.5),
        stream.between(0.38, 0.52),
        stream.between(0.3, 0.65),
    )


def chair(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return a chair with four legs and a back of slats, of bars or closed."""
    builder = PieceBuilder()
    thickness = min(stream.between(0.02, 0.08), 0.5 * seat.height)
    leg, closed = stream.between(0.025, 0.05), stream.uniform()
    _plate(builder, seat, thickness)
    x, z = 0.5 * (seat.width - leg), 0.5 * (seat.depth - leg)
    for side in (-x, x):
        builder.bar((side, 0.0, z), (side, seat.height - thickness, z), leg)
        builder.bar((side, 0.0, -z), (side, seat.height - thickness, -z), leg)
    if not seat.back:
        return builder.build()
    slope, depth = stream.between(0.0, 0.25) * seat.back, stream.between(0.02, 0.05)
    foot, top = seat.height - thickness, seat.height + seat.back
    behind = -0.5 * seat.depth - 0.5 * depth
    for side in (-x, x):
        builder.bar((side, foot, behind), (side, top, behind - slope), leg, depth)
    if closed < 0.5:  # a closed back
        low = seat.height + closed * seat.back
        start = behind - slope * closed
        builder.bar((0.0, low, start), (0.0, top, behind - slope), seat.width, depth)
    elif closed < 0.75:  # slats
        for part in (0.45, 0.7, 0.95):
            at = behind - slope * part
            builder.box((0.0, seat.height + part * seat.back, at), (seat.width, 0.06, depth))
    else:  # upright bars
        builder.box((0.0, top, behind - slope), (seat.width, 0.06, depth))
        for part in (-0.5, 0.0, 0.5):
            builder.bar(
                (part * x, seat.height, behind), (part * x, top, behind - slope), 0.5 * leg
            )
    if stream.bernoulli(0.25):
        _armrests(builder, seat, leg)
    return builder.build()


def office_chair(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return a swivel chair: a cushion and a back on a column with five feet."""
    builder = PieceBuilder()
    thickness = min(stream.between(0.05, 0.1), 0.4 * seat.height)
    builder.cushion(
        (0.0, seat.height - 0.5 * thickness, 0.0), (seat.width, thickness, seat.depth), 0.3
    )
    hub = min(0.12, 0.3 * seat.height)
    builder.post((0.0, hub, 0.0), seat.height - thickness - hub, 0.03)
    for x, z in ((0.0, 0.3), (0.29, 0.09), (0.18, -0.24), (-0.18, -0.24), (-0.29, 0.09)):
        builder.bar((0.0, hub, 0.0), (x, 0.04, z), 0.05, 0.03)
    if seat.back:
        thick, behind = stream.between(0.04, 0.09), -0.5 * seat.depth
        slope = stream.between(0.0, 0.2) * seat.back
        low = seat.height + stream.between(0.0, 0.2) * seat.back
        builder.bar(
            (0.0, low, behind - 0.5 * thick),
            (0.0, seat.height + seat.back, behind - 0.5 * thick - slope),
            seat.width * stream.between(0.8, 1.0),
            thick,
        )
        builder.bar((0.0, seat.height - 0.05, 0.0), (0.0, low + 0.1, behind - thick), 0.07, 0.03)
        if stream.bernoulli(0.4):
            _armrests(builder, seat, 0.05)
    return builder.build()


def stool(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return a stool: a disc or a cushion on a column or on three or four legs."""
    builder = PieceBuilder()
    thickness = min(stream.between(0.02, 0.08), 0.4 * seat.height)
    radius = 0.5 * min(seat.width, seat.depth)
    under = seat.height - thickness
    builder.post((0.0, under, 0.0), thickness, radius)
    if stream.bernoulli(0.4):
        builder.post((0.0, 0.0, 0.0), under, stream.between(0.02, 0.04))
        builder.post((0.0, 0.0, 0.0), 0.03, stream.between(0.6, 1.0) * radius)
        return builder.build()
    spread = radius * stream.between(0.7, 1.1)
    for x, z in ((0.7, 0.7), (-0.7, 0.7), (-0.7, -0.7), (0.7, -0.7)):
        builder.bar(
            (spread * x, 0.0, spread * z), (0.6 * radius * x, under, 0.6 * radius * z), 0.03
        )
    return builder.build()


def box_seat(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return a box, a hassock or a bench with closed sides."""
    builder = PieceBuilder()
    if stream.bernoulli(0.4):
        builder.cushion((0.0, 0.5 * seat.height, 0.0), (seat.width, seat.height, seat.depth), 0.25)
    else:
        builder.box((0.0, 0.5 * seat.height, 0.0), (seat.width, seat.height, seat.depth))
    return builder.build()


def armchair(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return an armchair: padded back and arms beside the seat."""
    return _padded(seat, 1, stream)


def sofa(seat: SeatSize, stream: RandomStream) -> Piece:
    """Return a sofa with two or three places, with cushions and blankets on some."""
    return _padded(seat, stream.choose(((0.5, 2), (0.5, 3))), stream)


def bed(stream: RandomStream) -> Piece:
    """Return a bed with pillows and a blanket, sometimes in a heap."""
    builder = PieceBuilder()
    width, length = stream.between(0.8, 1.8), stream.between(1.9, 2.1)
    frame, mattress = stream.between(0.15, 0.4), stream.between(0.12, 0.28)
    builder.box((0.0, 0.5 * frame, 0.0), (width, frame, length))
    top = frame + mattress
    builder.cushion((0.0, frame + 0.5 * mattress, 0.0), (width, mattress, length), 0.25)
    builder.box((0.0, 0.5 * (top + 0.4), -0.5 * length - 0.03), (width, top + 0.4, 0.05))
    for x in (-0.25, 0.25) if width > 1.2 else (0.0,):
        builder.cushion((x * width, top + 0.07, -0.5 * length + 0.25), (0.6, 0.16, 0.4))
    size = (
        width * stream.between(0.4, 1.05),
        stream.between(0.05, 0.35),
        stream.between(0.5, 1.5),
    )
    builder.cushion((0.0, top + 0.3 * size[1], stream.between(-0.2, 0.4)), size, 0.7)
    return builder.build()


def berth(width: float, length: float, height: float, stream: RandomStream) -> Piece:
    """Return a bed or a sofa for somebody who lies on it, the head at its back.

    Args:
        width: metres.
        length: metres.
        height: of the surface to lie on, metres.
        stream: the source of randomness.
    """
    builder = PieceBuilder()
    soft = min(stream.between(0.1, 0.25), 0.5 * height)
    builder.box((0.0, 0.5 * (height - soft), 0.0), (width, height - soft, length))
    builder.box((0.0, height - 0.5 * soft, 0.0), (width, soft, length))
    kind, board = stream.uniform(), height + stream.between(0.1, 0.5)
    if kind < 0.4:  # a bed
        builder.box((0.0, 0.5 * board, -0.5 * length - 0.03), (width, board, 0.05))
    elif kind < 0.75:  # a sofa with its back at one side
        side = (0.5 * width + 0.09) * (1.0 if stream.bernoulli(0.5) else -1.0)
        builder.cushion((side, 0.5 * board, 0.0), (0.18, board, length), 0.3)
        for end in (-0.5, 0.5):
            arm = height + stream.between(0.05, 0.25)
            builder.cushion((0.0, 0.5 * arm, end * (length + 0.18)), (width, arm, 0.18), 0.3)
    return builder.build()


SEATS: tuple[tuple[float, Callable[[SeatSize, RandomStream], Piece]], ...] = (
    (0.28, chair), (0.16, office_chair), (0.12, stool), (0.1, box_seat), (0.16, armchair),
    (0.18, sofa),
)  # fmt: skip
"""Kinds of seats with their frequency."""


def _plate(builder: PieceBuilder, seat: SeatSize, thickness: float) -> None:
    middle = seat.height - 0.5 * thickness
    builder.box((0.0, middle, 0.0), (seat.width, thickness, seat.depth))


def _armrests(builder: PieceBuilder, seat: SeatSize, width: float) -> None:
    top, ahead = seat.height + 0.22, 0.25 * seat.depth
    for x in (-0.5 * seat.width - width, 0.5 * seat.width + width):
        builder.bar((x, top, ahead), (x, top, -0.5 * seat.depth), width)
        builder.bar((x, seat.height - 0.04, ahead), (x, top, ahead), width)


def _padded(seat: SeatSize, places: int, stream: RandomStream) -> Piece:
    """Return an armchair or a sofa; the place at its origin is free."""
    builder = PieceBuilder()
    place = max(seat.width, 0.5) + 0.08
    first = -int(places * stream.uniform())  # the places left and right of the free one
    left, right = (first + places - 0.5) * place, (first - 0.5) * place
    middle, width = 0.5 * (left + right), left - right
    pad, exponent = stream.between(0.1, 0.2), stream.between(0.15, 0.4)
    back = max(seat.back, 0.3) if seat.back else 0.4
    base = 0.6 * seat.height
    deep = seat.depth + 0.12
    builder.box((middle, 0.5 * base + 0.02, -0.06), (width, base - 0.04, deep))
    for number in range(places):
        size = (place, seat.height - base, seat.depth)
        builder.cushion(((first + number) * place, 0.5 * (seat.height + base), 0.0), size, 0.2)
    behind = -0.5 * (seat.depth + pad)
    builder.cushion(
        (middle, 0.5 * (seat.height + back), behind), (width, seat.height + back, pad), exponent
    )
    if stream.bernoulli(0.85):
        arm = seat.height + stream.between(0.08, 0.28)
        for x in (left + 0.5 * pad, right - 0.5 * pad):
            builder.cushion((x, 0.5 * arm, -0.06), (pad, arm, deep), exponent)
    for number in range(places):
        if first + number == 0:
            continue
        at, kind = (first + number) * place, stream.uniform()
        lift = stream.between(0.15, 0.45)
        if kind < 0.4:  # a cushion that leans on the back
            builder.cushion((at, seat.height + 0.2, -0.5 * seat.depth + 0.1), (0.45, 0.4, 0.16))
        elif kind < 0.65:  # a blanket in a heap
            builder.cushion((at, seat.height + 0.3 * lift, 0.0), (0.8 * place, lift, 0.4), 0.8)
    return builder.build()
