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

"""What is wrong with single labelled joints, and their removal."""

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, PARENTS
from lsc_pose_ros.data_types.skeletons import Skeletons

OUTSIDE, BEFORE, DEEP, LENGTH = 'outside', 'before', 'deep', 'length'

KINDS: Mapping[str, str] = {
    OUTSIDE: 'outside of the mask of the body',
    BEFORE: 'before the surface that the camera sees',
    DEEP: 'too deep behind that surface',
    LENGTH: 'at the end of a limb of another length than usual',
}
"""What users call each kind of problem."""

SHORT_KINDS: Mapping[str, str] = {
    OUTSIDE: 'off the mask',
    BEFORE: 'before the surface',
    DEEP: 'too deep',
    LENGTH: 'at a limb of odd length',
}
"""The same in few words, after the number of joints."""

LIMBS = tuple((JOINT_NUMBERS[parent], JOINT_NUMBERS[child]) for child, parent in PARENTS.items())
"""The limbs, as the numbers of their joints: parent and child."""


class LabelLimits(NamedTuple):
    """How far off a label may be.

    Attributes:
        margin: from the mask, pixels.
        before: before the surface, metres.
        deep: behind the surface, metres.
        length: the relative change of the length of a limb.
    """

    margin: int = 3
    before: float = 0.03
    deep: float = 0.5
    length: float = 0.25


# Smaller changes of a length are those of a short limb, and harmless; metres.
_LEAST_CHANGE = 0.05

_DEFAULT_LIMITS = LabelLimits()


def near_mask(
    positions: NDArray[np.float32], mask: NDArray[np.bool_], camera: Intrinsics, margin: int
) -> NDArray[np.bool_]:
    """Return which joints, shape (J, 3), project onto `mask` or within `margin` pixels of it."""
    height, width = mask.shape
    pixels = project(positions, camera)
    seen: NDArray[np.bool_] = np.asarray(np.isfinite(pixels).all(axis=1))
    # Clipping keeps the numbers within int32, however far outside a label is.
    limits = (width + margin, height + margin)
    centre = np.rint(np.clip(np.where(seen[:, None], pixels, 0), -margin - 1, limits))
    steps = np.arange(-margin, margin + 1)
    down, right = np.meshgrid(steps, steps, indexing='ij')
    disc = down**2 + right**2 <= margin**2
    columns = centre[:, :1].astype(np.int32) + right[disc]
    rows = centre[:, 1:].astype(np.int32) + down[disc]
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    hit = mask[np.where(inside, rows, 0), np.where(inside, columns, 0)] & inside
    near: NDArray[np.bool_] = hit.any(axis=1) & seen
    return near


def behind_surface(
    positions: NDArray[np.float32], body: NDArray[np.bool_], frame: Frame
) -> NDArray[np.float64]:
    """Return how far joints are behind the surface of their body, metres, shape (J,).

    Args:
        positions: metres, NaN if unknown, shape (J, 3).
        body: the pixels of the body, shape (H, W).
        frame: the depth image and the camera.

    Returns:
        NaN for a joint that is unknown, or whose pixel has no depth or is not on the body.
    """
    height, width = body.shape
    pixels = project(positions, frame.camera)
    behind = np.full(len(positions), np.nan)
    for joint, pixel in enumerate(pixels):
        if not (np.isfinite(pixel).all() and (pixel > -0.5).all()):
            continue
        column, row = (int(each) for each in np.rint(np.minimum(pixel, max(width, height))))
        if column < width and row < height and body[row, column] and frame.depth[row, column] > 0:
            behind[joint] = positions[joint, 2] - frame.depth[row, column]
    return behind


def limb_lengths(positions: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the lengths of LIMBS, shape (..., L), of joints of shape (..., 20, 3)."""
    parents, children = np.array(LIMBS).T
    difference = positions[..., children, :].astype(np.float64) - positions[..., parents, :]
    return np.asarray(np.linalg.norm(difference, axis=-1))


def find_problems(
    frame: Frame,
    skeletons: Skeletons,
    limits: LabelLimits = _DEFAULT_LIMITS,
    usual_lengths: Mapping[int, NDArray[np.float64]] = MappingProxyType({}),
) -> dict[str, NDArray[np.bool_]]:
    """Return which joints have a problem, by its kind, shape (B, 20) each.

    Args:
        frame: depth and mask. Where it has no body of a skeleton's number, nothing is known about
            mask and surface.
        skeletons: the labels, with all 20 joints.
        limits: how far off a label may be.
        usual_lengths: of LIMBS, metres, shape (L,), by body number; the lengths of other bodies
            are not checked.
    """
    shape = skeletons.confidence.shape
    found = {kind: np.zeros(shape, bool) for kind in KINDS}
    for row, (number, positions) in enumerate(
        zip(skeletons.bodies, skeletons.positions, strict=True)
    ):
        labelled = np.isfinite(positions).all(axis=1)
        body = frame.labels == int(number)
        if body.any():
            near = near_mask(positions, body, frame.camera, limits.margin)
            found[OUTSIDE][row] = labelled & ~near
            behind = behind_surface(positions, body, frame)
            found[BEFORE][row] = behind < -limits.before
            found[DEEP][row] = behind > limits.deep
        usual = usual_lengths.get(int(number))
        if usual is not None:
            found[LENGTH][row] = _odd_lengths(positions, usual, limits.length)
    return found


def _odd_lengths(
    positions: NDArray[np.float32], usual: NDArray[np.float64], most: float
) -> NDArray[np.bool_]:
    """Return which joints are the far end of a limb of an unusual length, shape (20,)."""
    change = np.abs(limb_lengths(positions) - usual)
    odd = np.zeros(len(JOINT_NAMES), bool)
    odd[[child for _, child in LIMBS]] = change > np.maximum(most * usual, _LEAST_CHANGE)
    return odd


def without_problems(
    skeletons: Skeletons, problems: Mapping[str, NDArray[np.bool_]], kinds: Collection[str]
) -> Skeletons:
    """Return `skeletons` with NaN for joints that have a problem of one of `kinds`."""
    positions, confidence = skeletons.positions.copy(), skeletons.confidence.copy()
    for kind in kinds:
        positions[problems[kind]] = np.nan
        confidence[problems[kind]] = 0
    return skeletons._replace(positions=positions, confidence=confidence)
