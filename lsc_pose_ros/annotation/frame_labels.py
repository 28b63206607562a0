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
"""The labels of one frame, and how they are changed."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import back_project, project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.conversion import LARGEST_BODY
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import HIDDEN, SEEN, UNKNOWN
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.sources.keypoints import SURFACE_TO_JOINT, surface_depth
from lsc_pose_ros.labels.tracks import skeletons_of

NEAREST, FARTHEST = 0.1, 100.0
"""The least and the largest depth that a joint can be given, metres."""

MOST_BODIES = 32
"""No frame has more labelled bodies."""

_USUAL_DEPTH = 2.0  # metres, of a person in an image without depth


class BodyLabels(NamedTuple):
    """The labels of one body.

    Attributes:
        positions: of all joints in the optical frame, metres, NaN if not labelled, shape (20, 3).
        hidden: whether something hides the joint, shape (20,).
    """

    positions: NDArray[np.float64]
    hidden: NDArray[np.bool_]


class PlacedJoint(NamedTuple):
    """Where a joint is that was put on a pixel.

    Attributes:
        position: metres, in the optical frame, shape (3,).
        depth_from: where its depth is from: SURFACE, BEFORE or USUAL.
    """

    position: NDArray[np.float64]
    depth_from: str


SURFACE = 'surface'
"""The depth is that of a body's surface there and SURFACE_TO_JOINT."""

BEFORE = 'before'
"""The depth is that of the joint before, because no body is there."""

USUAL = 'usual'
"""The depth is the median of the image, or that of a usual person."""

FrameLabels = dict[int, BodyLabels]
"""The labels of a frame, by body number."""


def labels_of(skeletons: Skeletons) -> FrameLabels:
    """Return skeletons as labels; joints that are hidden by something, or outside, are hidden."""
    labels: FrameLabels = {}
    for row, number in enumerate(skeletons.bodies.tolist()):
        positions = np.full((len(JOINT_NAMES), 3), np.nan)
        hidden = np.zeros(len(JOINT_NAMES), np.bool_)
        positions[skeletons.joints] = skeletons.positions[row]
        if skeletons.visibility is not None:
            hidden[skeletons.joints] = ~np.isin(skeletons.visibility[row], (SEEN, UNKNOWN))
        labels[number] = BodyLabels(positions, hidden)
    return labels


def skeletons_from(labels: FrameLabels) -> Skeletons:
    """Return labels as skeletons; bodies without any joint are left out."""
    skeletons = skeletons_of({number: body.positions for number, body in labels.items()})
    hidden = [labels[number].hidden for number in skeletons.bodies.tolist()]
    visibility = np.where(np.array(hidden, np.bool_), HIDDEN, SEEN).astype(np.uint8)
    visibility = visibility.reshape(len(skeletons.bodies), len(JOINT_NAMES))
    known = np.isfinite(skeletons.positions).all(axis=-1)
    return skeletons._replace(visibility=np.where(known, visibility, np.uint8(UNKNOWN)))


def joint_at(
    pixel: tuple[float, float], joint: int, frame: Frame, before: NDArray[np.float64]
) -> PlacedJoint:
    """Return where a joint is that is put on a pixel.

    Its depth is that of a body's surface there and SURFACE_TO_JOINT. If no body is there, it is
    the depth before; without that, the median of the image.

    Args:
        pixel: column and row.
        joint: its number.
        frame: the frame; if it has no bodies, any surface is taken for one.
        before: its position before, metres, NaN if not labelled, shape (3,).
    """
    is_body = frame.labels != NO_BODY
    depth = np.where(is_body, frame.depth, np.float32(0)) if is_body.any() else frame.depth
    z = surface_depth(np.array(pixel), depth) + float(SURFACE_TO_JOINT[joint])
    if math.isfinite(z):
        source = SURFACE
    elif math.isfinite(before[2]):
        z, source = float(before[2]), BEFORE
    else:
        known = frame.depth[np.isfinite(frame.depth) & (frame.depth > 0)]
        z, source = (float(np.median(known)) if known.size else _USUAL_DEPTH), USUAL
    return PlacedJoint(position_at(pixel, z, frame.camera), source)


def people_box(labels: NDArray[np.int32]) -> list[int] | None:
    """Return the first and last column and row of all bodies: left, top, right, bottom.

    Args:
        labels: the number of the body that a pixel shows, or NO_BODY, shape (H, W).
    """
    rows, columns = np.nonzero(labels != NO_BODY)
    if not rows.size:
        return None
    return [int(each) for each in (columns.min(), rows.min(), columns.max(), rows.max())]


def position_at(pixel: tuple[float, float], z: float, camera: Intrinsics) -> NDArray[np.float64]:
    """Return the point at depth `z`, metres, that a pixel (column, row) shows, shape (3,)."""
    columns, rows = (np.array([value]) for value in pixel)
    point: NDArray[np.float64] = back_project(columns, rows, np.array([z]), camera)[0].astype(
        float
    )
    return point


def without_pixels(labels: FrameLabels) -> list[dict[str, Any]]:
    """Return labels as JSON: the joints of each body, with their positions in metres."""
    return [
        {
            'number': number,
            'joints': {
                name: {'position': position.tolist(), 'hidden': bool(hidden)}
                for name, position, hidden in zip(JOINT_NAMES, *body, strict=True)
                if np.isfinite(position).all()
            },
        }
        for number, body in sorted(labels.items())
    ]


def with_pixels(labels: FrameLabels, camera: Intrinsics) -> list[dict[str, Any]]:
    """Return labels for the page: also the pixels where the joints are, None where none is."""
    bodies = without_pixels(labels)
    for body in bodies:
        pixels = project(labels[body['number']].positions, camera)
        for name, joint in body['joints'].items():
            pixel = pixels[JOINT_NUMBERS[name]].tolist()
            joint['pixel'] = pixel if all(map(math.isfinite, pixel)) else None
    return bodies


def from_json(bodies: object) -> FrameLabels:
    """Return the labels that a page or a journal gives.

    Raises:
        InputError: they are none.
    """
    if not isinstance(bodies, list) or len(bodies) > MOST_BODIES:
        msg = f'the bodies must be a list of at most {MOST_BODIES}'
        raise InputError(msg)
    labels: FrameLabels = {}
    for body in bodies:
        number = body.get('number') if isinstance(body, dict) else None
        joints = body.get('joints') if isinstance(body, dict) else None
        if type(number) is not int or not 0 <= number <= LARGEST_BODY or number in labels:
            msg = f'a body needs a number from 0 to {LARGEST_BODY}, each another'
            raise InputError(msg)
        if not isinstance(joints, dict):
            msg = f'body {number} needs joints by their names'
            raise InputError(msg)
        labels[number] = _body(joints)
    return labels


def _body(joints: dict[object, object]) -> BodyLabels:
    positions = np.full((len(JOINT_NAMES), 3), np.nan)
    hidden = np.zeros(len(JOINT_NAMES), np.bool_)
    for name, joint in joints.items():
        index = JOINT_NUMBERS.get(name) if isinstance(name, str) else None
        position = joint.get('position') if isinstance(joint, dict) else None
        if index is None:
            msg = f'there is no joint {str(name)[:40]!r}'
            raise InputError(msg)
        if not _is_position(position):
            msg = (
                f'the position of {name} must be three numbers in metres, before the camera and '
                f'at most {FARTHEST:g} m from it along each axis'
            )
            raise InputError(msg)
        positions[index] = position
        hidden[index] = isinstance(joint, dict) and joint.get('hidden') is True
    return BodyLabels(positions, hidden)


def _is_position(position: object) -> bool:
    return (
        isinstance(position, list)
        and len(position) == len('xyz')
        and all(type(value) in {int, float} and abs(value) <= FARTHEST for value in position)
        and position[2] > 0
    )
