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

"""Imports MSR-Action3D (Li, Zhang, Liu, CVPR workshop 2010): people who face a depth camera.

The unit of its depth, the intrinsics, left and right, and whether images are mirrored are not
published; all follow from the skeletons, which are given in metres and in pixels. Where images are
mirrored, they and the positions are flipped.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.datasets.image_folder import EPOCH, FRAME_ID
from lsc_pose_ros.datasets.msr_action3d_files import MsrSequence, read_msr_depth
from lsc_pose_ros.datasets.msr_action3d_sides import Sides, find_sides
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.sources.keypoints import SURFACE_TO_JOINT, surface_depth
from lsc_pose_ros.labels.tracks import skeletons_of
from lsc_pose_ros.labels.vocabulary import Vocabulary, load_vocabulary

BODY = 1
FRAME_RATE = 15
_SECOND = 1_000_000_000

# From so many frames, spread over the sequences, unit and intrinsics are found.
_MOST_FRAMES = 200
_FEWEST_JOINTS = 50

# The largest median error of a joint's depth and pixel after the fit, metres and pixels.
_LARGEST_DEPTH_ERROR, _LARGEST_PIXEL_ERROR = 0.1, 3.0


class MsrCamera(NamedTuple):
    """What the skeletons tell of the camera.

    Attributes:
        intrinsics: of the images as they are stored.
        unit: metres per unit of depth.
        x_sign: -1 if x points to image left, else 1.
    """

    intrinsics: Intrinsics
    unit: float
    x_sign: float


def import_msr(sequences: Sequence[MsrSequence]) -> Iterator[Frame]:
    """Yield the frames of sequences at 15 Hz, with a second between sequences.

    Raises:
        InputError: a file cannot be read, or the skeletons do not fit the depth images.
    """
    sides = find_sides(sequences)
    camera = fit_msr_camera(sequences)
    start = EPOCH
    for sequence in sequences:
        depth = read_msr_depth(sequence.depth)
        _check_length(sequence, depth)
        positions = sides.ordered(sequence.positions) * (camera.x_sign, -1.0, 1.0)
        for number, (image, joints) in enumerate(zip(depth, positions, strict=True)):
            stamp = start + number * _SECOND // FRAME_RATE
            yield _frame(stamp, image, joints, camera, sides)
        start += len(depth) * _SECOND // FRAME_RATE + _SECOND


def _frame(
    stamp: int,
    image: NDArray[np.int32],
    joints: NDArray[np.float64],
    camera: MsrCamera,
    sides: Sides,
) -> Frame:
    depth = (image * camera.unit).astype(np.float32)
    intrinsics = camera.intrinsics
    if sides.mirrored:
        depth = np.ascontiguousarray(depth[:, ::-1])
        joints = joints * (-1.0, 1.0, 1.0)
        intrinsics = intrinsics._replace(cx=depth.shape[1] - 1 - intrinsics.cx)
    return Frame(
        stamp,
        FRAME_ID,
        depth,
        np.where(depth > 0, BODY, NO_BODY).astype(np.int32),
        intrinsics,
        skeletons_of({BODY: _vocabulary().ours(joints)}),
    )


def fit_msr_camera(sequences: Sequence[MsrSequence]) -> MsrCamera:
    """Return the camera that fits best to positions, pixels and depth, by least squares.

    The unit is the median over joints of the distance of the surface before the joint, in metres,
    by the depth of its pixel.

    Raises:
        InputError: too few joints are known, or the skeletons do not fit the depth images.
    """
    step = max(1, sum(len(each.positions) for each in sequences) // _MOST_FRAMES)
    ratios, directions, pixels = [], [], []
    for sequence in sequences:
        depth = read_msr_depth(sequence.depth)
        _check_length(sequence, depth)
        for index in range(0, len(depth), step):
            joints = _vocabulary().ours(sequence.positions[index])
            flat = np.concatenate(
                [sequence.pixels[index], np.zeros((len(sequence.pixels[index]), 1))], axis=1
            )
            places = _vocabulary().ours(flat)[:, :2]
            ratios.append(_units(joints, places, depth[index]))
            directions.append(joints[:, :2] / joints[:, 2:])
            pixels.append(places)
    return _fitted(np.concatenate(ratios), np.concatenate(directions), np.concatenate(pixels))


def _units(
    joints: NDArray[np.float64], places: NDArray[np.float64], depth: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Return the unit of depth that each joint tells, and the depth in that unit, shape (J, 2)."""
    image = depth.astype(np.float32)
    surface = np.array([surface_depth(place, image) for place in places])
    return np.stack([(joints[:, 2] - SURFACE_TO_JOINT) / surface, surface], axis=1)


def _fitted(
    units: NDArray[np.float64], directions: NDArray[np.float64], pixels: NDArray[np.float64]
) -> MsrCamera:
    known = np.isfinite(units).all(axis=1) & np.isfinite(directions).all(axis=1)
    if known.sum() < _FEWEST_JOINTS:
        msg = (
            f'only {known.sum()} joints of the sequences have a position, a pixel and depth; '
            f'{_FEWEST_JOINTS} are needed to find the unit of depth and the intrinsics'
        )
        raise InputError(msg)
    unit = float(np.median(units[known, 0]))
    errors = np.abs(units[known, 0] - unit) * units[known, 1]
    (fx, cx), (fy, cy) = (
        np.polyfit(directions[known, axis], pixels[known, axis], 1) for axis in (0, 1)
    )
    fitted = directions[known] * (fx, fy) + (cx, cy)
    pixel_error = float(np.median(np.linalg.norm(fitted - pixels[known], axis=1)))
    if np.median(errors) > _LARGEST_DEPTH_ERROR or pixel_error > _LARGEST_PIXEL_ERROR or fy > 0:
        msg = (
            f'the skeletons do not fit the depth images: the median error is '
            f'{np.median(errors):.2f} m in depth and {pixel_error:.1f} pixels; are they the files '
            'of the same sequences?'
        )
        raise InputError(msg)
    intrinsics = Intrinsics(abs(float(fx)), -float(fy), float(cx), float(cy))
    return MsrCamera(intrinsics, unit, float(np.sign(fx)))


def _check_length(sequence: MsrSequence, depth: NDArray[np.int32]) -> None:
    if len(depth) != len(sequence.positions):
        msg = (
            f'{sequence.depth} has {len(depth)} depth images, but its skeleton files have '
            f'{len(sequence.positions)} skeletons; remove the three files, or fetch them again'
        )
        raise InputError(msg)


@cache
def _vocabulary() -> Vocabulary:
    return load_vocabulary('msr_action3d')
