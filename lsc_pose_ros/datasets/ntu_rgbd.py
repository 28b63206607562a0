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

"""Imports NTU RGB+D (Shahroudy, Liu, Ng, Wang, CVPR 2016): people in front of a Kinect v2.

A sequence is a text file NAME.skeleton and a folder NAME of depth images, MDepth-00000001.png,
16 bits, millimetres, foreground only (the masked depth maps). The Kinect v2 mirrors its images:
as with UTD-MHAD, they are flipped, and positions (X, Y up, Z) become (-X, -Y, Z). The intrinsics
follow from the pixel of each joint, which the file has beside its position.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.datasets.image_folder import EPOCH, FRAME_ID, read_png
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.body_matching import numbered_as_mask
from lsc_pose_ros.labels.tracks import skeletons_of
from lsc_pose_ros.labels.vocabulary import Vocabulary, load_vocabulary

FRAME_RATE = 30
_IMAGE = re.compile(r'MDepth-([0-9]{1,9})\.png')
_SECOND = 1_000_000_000
_JOINTS = 25
_COLUMNS = 12  # of a joint: x y z, depth x y, colour x y, orientation w x y z, state
_BODY_COLUMNS = 10
_NOT_TRACKED = 0
_LARGEST = 1e6

# The nominal intrinsics of the depth camera, if a file has too few joints to fit them.
_NOMINAL = Intrinsics(365.5, 365.5, 255.5, 211.5)
_FEWEST = 50


class SkeletonFrame(NamedTuple):
    """The bodies of one frame, N of them, with 25 joints each.

    Attributes:
        positions: in the axes of the Kinect, metres, NaN if not tracked, shape (N, 25, 3).
        pixels: in the depth image, shape (N, 25, 2).
    """

    positions: NDArray[np.float64]
    pixels: NDArray[np.float64]


class NtuSequence(NamedTuple):
    """A sequence: its skeleton file and its depth images by their numbers, from 1."""

    skeleton: Path
    images: Mapping[int, Path]


def find_sequences(skeletons: Path, depth: Path) -> list[NtuSequence]:
    """Return the sequences that have both skeletons and depth images, sorted by name.

    Args:
        skeletons: the folder of the .skeleton files.
        depth: the folder of the folders of depth images.

    Raises:
        InputError: there are none.
    """
    sequences = []
    for path in sorted(skeletons.glob('*.skeleton')):
        names = (depth / path.stem).glob('MDepth-*.png')
        images = {int(found[1]): each for each in names if (found := _IMAGE.fullmatch(each.name))}
        if images:
            sequences.append(NtuSequence(path, images))
    if not sequences:
        msg = (
            f'{skeletons} has no NAME.skeleton with a folder {depth}/NAME of depth images '
            'MDepth-00000001.png; give the folders of NTU RGB+D'
        )
        raise InputError(msg)
    return sequences


def import_ntu(sequences: Sequence[NtuSequence], left_out: Counter[str]) -> Iterator[Frame]:
    """Yield the frames of sequences, without mirroring, with a second between sequences.

    Args:
        sequences: the sequences.
        left_out: counts the images and the skeletons that are left out, because the other one of
            the same number is missing.

    Raises:
        InputError: a file cannot be read.
    """
    start = EPOCH
    for sequence in sequences:
        skeletons = read_skeleton_file(sequence.skeleton)
        camera = fit_camera(skeletons)
        for number, bodies in enumerate(skeletons):
            path = sequence.images.get(number + 1)
            if path is None:
                left_out['skeletons without an image'] += 1
                continue
            stamp = start + number * _SECOND // FRAME_RATE
            yield _frame(stamp, read_png(path), bodies, camera)
        surplus = sum(not 1 <= number <= len(skeletons) for number in sequence.images)
        if surplus:
            left_out['images without a skeleton'] += surplus
        start += len(skeletons) * _SECOND // FRAME_RATE + _SECOND


def _frame(
    stamp: int, millimetres: NDArray[np.uint16], bodies: SkeletonFrame, camera: Intrinsics
) -> Frame:
    depth = np.ascontiguousarray(millimetres[:, ::-1]).astype(np.float32) / np.float32(1000)
    camera = camera._replace(cx=depth.shape[1] - 1 - camera.cx)
    ours = _vocabulary().ours(bodies.positions * (-1.0, -1.0, 1.0))
    skeletons = skeletons_of(dict(enumerate(ours, start=1)))
    labels = body_labels(depth, ours, camera)
    frame = Frame(stamp, FRAME_ID, depth, labels, camera, skeletons)
    return frame._replace(ground_truth=numbered_as_mask(skeletons, frame))


@cache
def _vocabulary() -> Vocabulary:
    return load_vocabulary('kinect_v2')


def body_labels(
    depth: NDArray[np.float32], positions: NDArray[np.floating], camera: Intrinsics
) -> NDArray[np.int32]:
    """Return the number of the body that each pixel with depth shows, shape (H, W).

    It is that of the nearest joint, whose bodies are numbered from 1.
    """
    labels = np.full(depth.shape, NO_BODY, np.int32)
    rows, columns = np.nonzero(depth > 0)
    if not len(rows) or not len(positions):
        return labels
    points = back_project(columns, rows, depth[rows, columns], camera)
    nearest = np.full(len(points), np.inf)
    for number, joints in enumerate(positions, start=1):
        known = joints[np.isfinite(joints).all(axis=1)]
        for joint in known:
            distance = np.linalg.norm(points - joint, axis=1)
            closer = distance < nearest
            nearest[closer] = distance[closer]
            labels[rows[closer], columns[closer]] = number
    return labels


def fit_camera(frames: Sequence[SkeletonFrame]) -> Intrinsics:
    """Return the intrinsics with which the positions project to the pixels, by least squares.

    The nominal ones are returned if too few joints are known.
    """
    positions = np.concatenate([frame.positions.reshape(-1, 3) for frame in frames])
    pixels = np.concatenate([frame.pixels.reshape(-1, 2) for frame in frames])
    known = np.isfinite(positions).all(axis=1) & np.isfinite(pixels).all(axis=1)
    known &= positions[:, 2] > 0
    if known.sum() < _FEWEST:
        return _NOMINAL
    directions = positions[known, :2] / positions[known, 2:] * (1.0, -1.0)
    fits = [
        np.polyfit(direction, pixel, 1)
        for direction, pixel in zip(directions.T, pixels[known].T, strict=True)
    ]
    (fx, cx), (fy, cy) = fits
    fitted = Intrinsics(float(fx), float(fy), float(cx), float(cy))
    return fitted if min(fx, fy) > 0 and np.isfinite([fx, fy, cx, cy]).all() else _NOMINAL


def read_skeleton_file(path: Path) -> list[SkeletonFrame]:
    """Return the frames of a .skeleton file.

    Raises:
        InputError: it cannot be read or is damaged; the message names the line.
    """
    try:
        lines = path.read_text(encoding='ascii', errors='replace').splitlines()
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror or error}'
        raise InputError(msg) from error
    reader = iter(enumerate(lines, start=1))
    number = 0

    def numbers(count: int) -> list[float]:
        nonlocal number
        number, line = next(reader)
        values = [float(word) for word in line.split()]
        if len(values) != count:
            msg = f'{len(values)} numbers, but {count} are expected'
            raise ValueError(msg)
        return values

    try:
        frames = [_read_frame(numbers) for _ in range(int(numbers(1)[0]))]
    except StopIteration:
        msg = f'{path} ends too early, at line {number}; fetch it again'
        raise InputError(msg) from None
    except (ValueError, OverflowError) as error:
        msg = f'{path}, line {number}: {excerpt(error)}; fetch it again'
        raise InputError(msg) from error
    if not frames:
        msg = f'{path} has no frames; fetch it again'
        raise InputError(msg)
    return frames


def _read_frame(numbers: Callable[[int], list[float]]) -> SkeletonFrame:
    bodies = []
    for _ in range(int(numbers(1)[0])):
        numbers(_BODY_COLUMNS)
        if numbers(1)[0] != _JOINTS:
            msg = f'a body has not {_JOINTS} joints'
            raise ValueError(msg)
        joints = np.array([numbers(_COLUMNS) for _ in range(_JOINTS)])
        joints[joints[:, -1] == _NOT_TRACKED] = np.nan
        if (np.abs(joints[:, :5]) > _LARGEST).any():
            msg = f'a position or pixel is beyond {_LARGEST:g}'
            raise ValueError(msg)
        bodies.append(joints[:, :5])
    table = np.array(bodies).reshape(-1, _JOINTS, 5)
    return SkeletonFrame(table[..., :3], table[..., 3:])
