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

"""Pieces that stand about in a room: boxes, plants, lamps, robots, balls, ladders, poles."""

import numpy as np

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder
from lsc_pose_ros.synthetic.scene.shapes import leaves, loft, scattered

_CEILING = 3.5


def boxes(stream: RandomStream) -> Piece:
    """Return a box or a stack of up to four boxes."""
    builder = PieceBuilder()
    height, count = 0.0, int(stream.between(1, 5))
    largest = stream.between(0.25, 0.8)
    for _ in range(count):
        size = [largest * stream.between(0.6, 1.0) for _ in range(3)]
        angle = stream.between(-0.4, 0.4)
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
        x, z = stream.between(-0.08, 0.08), stream.between(-0.08, 0.08)
        builder.box((x, height + 0.5 * size[1], z), size, turned)
        height += size[1]
        if height > 1.3:
            break
    return builder.build()


def plant(stream: RandomStream) -> Piece:
    """Return a plant: a pot, a stem and a cloud of leaves."""
    builder = PieceBuilder()
    pot, radius = stream.between(0.15, 0.45), stream.between(0.1, 0.22)
    builder.post((0.0, 0.0, 0.0), pot, 0.8 * radius, radius)
    height = pot + stream.between(0.2, 1.4)
    builder.post((0.0, pot, 0.0), height - pot, 0.015)
    half = np.array([stream.between(0.15, 0.5), stream.between(0.15, 0.5), 0.0])
    half[2] = half[0] * stream.between(0.7, 1.0)
    half[1] = min(half[1], 0.5 * (height - 0.5 * pot))
    points = scattered(int(stream.between(60, 200))) * 2 * half
    builder.shape(leaves(points, stream.between(0.06, 0.2)), (0.0, height, 0.0))
    return builder.build()


def lamp(stream: RandomStream) -> Piece:
    """Return a floor lamp."""
    builder = PieceBuilder()
    height, radius = stream.between(1.1, 1.9), stream.between(0.1, 0.25)
    builder.post((0.0, 0.0, 0.0), height, 0.015)
    builder.post((0.0, 0.0, 0.0), 0.03, 0.15)
    builder.post(
        (0.0, height - 0.1, 0.0), stream.between(0.15, 0.4), radius, radius * stream.uniform()
    )
    return builder.build()


def robot(stream: RandomStream) -> Piece:
    """Return a mobile robot: a base, a body, often a head with a screen and arms."""
    builder = PieceBuilder()
    base, radius = stream.between(0.15, 0.5), stream.between(0.2, 0.35)
    builder.post((0.0, 0.05, 0.0), base, radius, radius * stream.between(0.7, 1.0))
    height = base + stream.between(0.2, 0.9)
    width = radius * stream.between(0.4, 0.9)
    builder.shape(
        loft((base, height), (width, width), (0.7 * width, 0.7 * width), exponent=0.4),
        (0.0, 0.0, 0.0),
    )
    if stream.bernoulli(0.6):
        size = (stream.between(0.15, 0.35), stream.between(0.12, 0.28), stream.between(0.08, 0.2))
        builder.post((0.0, height, 0.0), 0.08, 0.04)
        builder.cushion((0.0, height + 0.08 + 0.5 * size[1], 0.0), size, stream.between(0.3, 1.0))
    for side in (-1.0, 1.0):
        shoulder = np.array([side * (width + 0.04), height - 0.1, 0.0])
        elbow = shoulder + np.array(
            [side * stream.between(0.0, 0.2), stream.between(-0.35, 0.1), 0.1]
        )
        hand = elbow + np.array([0.0, stream.between(-0.3, 0.3), stream.between(0.1, 0.35)])
        if stream.bernoulli(0.45):
            builder.bar(shoulder, elbow, 0.08)
            builder.bar(elbow, hand, 0.06)
    return builder.build()


def round_things(stream: RandomStream) -> Piece:
    """Return a ball, a bin, a bucket, a rolled carpet or a heap of cloth."""
    builder = PieceBuilder()
    kind, radius = stream.uniform(), stream.between(0.1, 0.35)
    if kind < 0.25:
        builder.cushion((0.0, radius, 0.0), (2 * radius, 2 * radius, 2 * radius), 1.0)
    elif kind < 0.6:
        builder.post((0.0, 0.0, 0.0), stream.between(0.25, 0.8), 0.85 * radius, radius)
    elif kind < 0.75:
        builder.post((0.0, 0.0, 0.0), stream.between(0.8, 2.0), 0.4 * radius)
    else:
        size = (stream.between(0.4, 1.0), 3 * radius, stream.between(0.4, 0.8))
        builder.cushion((0.0, 0.3 * size[1], 0.0), size, stream.between(0.6, 1.1))
    return builder.build()


def ladder(stream: RandomStream) -> Piece:
    """Return a step ladder."""
    builder = PieceBuilder()
    height, width = stream.between(0.8, 2.0), stream.between(0.35, 0.5)
    spread = 0.3 * height
    for side in (-0.5, 0.5):
        x = side * width
        builder.bar((x, 0.0, spread), (x, height, 0.0), 0.05, 0.03)
        builder.bar((x, 0.0, -spread), (x, height, 0.0), 0.05, 0.03)
    for step in range(1, int(height / 0.27) + 1):
        part = 0.27 * step / height
        builder.box((0.0, part * height, spread * (1 - part)), (width, 0.03, 0.1))
    return builder.build()


def poles(stream: RandomStream) -> Piece:
    """Return poles, pipes or cables, upright or slanted, up to the ceiling."""
    builder = PieceBuilder()
    thickness = stream.between(0.01, 0.08)
    for _ in range(int(stream.between(1, 4))):
        x, z = stream.between(-0.3, 0.3), stream.between(-0.3, 0.3)
        slant, top = stream.between(-0.3, 0.3), stream.choose(((0.6, _CEILING), (0.4, 1.6)))
        builder.bar((x, 0.0, z), (x + slant, top, z), thickness)
    return builder.build()


def partition(stream: RandomStream) -> Piece:
    """Return a pillar, a piece of wall or a screen."""
    builder = PieceBuilder()
    width, depth = stream.between(0.15, 1.2), stream.between(0.03, 0.5)
    height = stream.choose(((0.5, _CEILING), (0.5, stream.between(1.2, 2.0))))
    builder.box((0.0, 0.5 * height, 0.0), (width, height, depth))
    return builder.build()


def robot_arm(height: float, stream: RandomStream) -> Piece:
    """Return the arm of the robot that carries the camera.

    Args:
        height: of the camera above the floor, metres.
        stream: the source of randomness.

    Returns:
        The piece, whose origin is below the camera; its front is where the camera looks.
    """
    builder = PieceBuilder()
    side = stream.choose(((0.5, -1.0), (0.5, 1.0)))
    width = stream.between(0.04, 0.1)
    shoulder = np.array(
        [side * stream.between(0.15, 0.45), height - stream.between(0.1, 0.4), 0.1]
    )
    elbow = np.array(
        [
            side * stream.between(0.05, 0.5),
            height + stream.between(-0.5, 0.0),
            stream.between(0.3, 0.5),
        ]
    )
    hand = np.array(
        [
            side * stream.between(-0.15, 0.3),
            height + stream.between(-0.4, 0.1),
            stream.between(0.5, 0.9),
        ]
    )
    builder.bar(shoulder, elbow, width)
    builder.bar(elbow, hand, 0.8 * width)
    builder.cushion(elbow, (1.3 * width, 1.3 * width, 1.3 * width), 1.0)
    for finger in (-0.04, 0.04):
        base = hand + np.array([finger, 0.0, 0.0])
        builder.bar(base, base + np.array([0.0, 0.0, 0.1]), 0.02)
    return builder.build()


def robot_deck(height: float, stream: RandomStream) -> Piece:
    """Return the deck below the camera on its robot or table; see `robot_arm`."""
    builder = PieceBuilder()
    width, ahead = stream.between(0.25, 1.2), stream.between(0.1, 0.7)
    thickness, drop = stream.between(0.03, 0.2), stream.between(0.06, 0.35)
    middle = (0.0, max(height - drop - 0.5 * thickness, 0.05), 0.5 * (ahead - 0.2))
    builder.box(middle, (width, thickness, ahead + 0.2))
    if stream.bernoulli(0.4):  # something that is mounted on it
        x, size = stream.between(-0.4, 0.4) * width, stream.between(0.03, 0.12)
        builder.post((x, height - drop, 0.8 * ahead), size, 0.5 * size)
    return builder.build()
