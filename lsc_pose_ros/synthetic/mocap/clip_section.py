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

"""Sections of clips: resampled, joined, and limited to a range of yaw."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.geometry.rotations import continuous_signs, signed_slerp, slerp
from lsc_pose_ros.synthetic.mocap.mocap_clip import MocapClip


class ClipSection(NamedTuple):
    """Motion in T frames.

    Attributes:
        orientations: of the segments, quaternions, shape (T, S, 4), as in `MocapClip`.
        heading: radians to the left, shape (T,).
        shoulders: whether the shoulders were captured.
    """

    orientations: NDArray[np.float64]
    heading: NDArray[np.float64]
    shoulders: bool


def resample(clip: MocapClip, times: NDArray[np.float64]) -> ClipSection:
    """Return the motion of `clip` at `times`, seconds from its first frame."""
    frames = np.clip(times * clip.rate, 0, len(clip.orientations) - 1)
    before = np.minimum(frames.astype(np.intp), max(len(clip.orientations) - 2, 0))
    after = np.minimum(before + 1, len(clip.orientations) - 1)
    orientations = clip.orientations.astype(np.float64)
    fraction = frames - before
    return ClipSection(
        slerp(orientations[before], orientations[after], fraction[:, None]),
        np.asarray(np.interp(frames, np.arange(len(clip.orientations)), clip.heading)),
        clip.shoulders,
    )


def join(first: ClipSection, second: ClipSection, blend: int) -> ClipSection:
    """Return `first` followed by `second`, with a smooth transition over `blend` frames."""
    u = (np.arange(blend) + 1) / (blend + 1)
    fraction = u * u * (3 - 2 * u)
    # The heading is continuous between the two.
    heading = second.heading - second.heading[0] + first.heading[-blend]
    start = len(first.orientations) - blend
    leaving, coming = (
        continuous_signs(first.orientations[start:]),
        continuous_signs(second.orientations[:blend]),
    )
    # The direction of the transition is decided once, because the shorter one can change during
    # it.
    opposite = (leaving[blend // 2] * coming[blend // 2]).sum(axis=-1, keepdims=True) < 0
    coming = np.where(opposite, -coming, coming)
    return ClipSection(
        np.concatenate(
            [
                first.orientations[:start],
                signed_slerp(leaving, coming, fraction[:, None]),
                second.orientations[blend:],
            ]
        ),
        np.concatenate(
            [
                first.heading[:start],
                (1 - fraction) * first.heading[start:] + fraction * heading[:blend],
                heading[blend:],
            ]
        ),
        first.shoulders and second.shoulders,
    )


def within_yaw(
    heading: NDArray[np.float64], widest: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Return `heading`, radians, shape (T,), with a random offset and within ±`widest`.

    If the range of the heading is too large, it is scaled down.
    """
    uniform = random.random()
    middle = (heading.max() + heading.min()) / 2
    half = float(np.ptp(heading)) / 2
    spare = widest - half
    centred = (heading - middle) * (1.0 if spare >= 0 else widest / half)
    if widest >= np.pi:
        return np.asarray(heading - middle + np.pi * (2 * uniform - 1))
    moved = centred + max(spare, 0.0) * (2 * uniform - 1)
    return np.asarray(np.clip(moved, -widest, widest))
