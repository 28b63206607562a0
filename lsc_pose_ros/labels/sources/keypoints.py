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

"""Labels from keypoints in the image, put behind the surface that the depth image shows."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import directions_of
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.interpolation import STAMP_TOLERANCE, nearest
from lsc_pose_ros.labels.sources.keypoint_files import LARGEST_PIXEL, Keypoints, KeypointsKey
from lsc_pose_ros.labels.tracks import LabelSettings, skeletons_of

# Medians over the joints that the camera sees, of 25 synthetic people of all ages in 100 frames.
DEPTH_BEHIND_SURFACE: Mapping[str, float] = {
    'head': 0.08, 'neck': 0.08, 'torso': 0.13, 'pelvis': 0.15,
    'shoulder': 0.06, 'elbow': 0.05, 'wrist': 0.03, 'hand': 0.02,
    'hip': 0.12, 'knee': 0.06, 'ankle': 0.05, 'foot': 0.03,
}  # fmt: skip
"""How far each joint is behind the surface that a camera sees there, metres."""

SURFACE_TO_JOINT = np.array(
    [DEPTH_BEHIND_SURFACE[name.removeprefix('l_').removeprefix('r_')] for name in JOINT_NAMES]
)
"""DEPTH_BEHIND_SURFACE of each of our joints, metres, shape (20,)."""

# The surface is the nearer side of the depths around the pixel: a limb before the trunk or the
# wall is meant, and single wrong pixels are not.
_RADIUS = 2
_SURFACE_QUANTILE = 0.3


class KeypointLabels:
    """Labels from the keypoints of each depth image."""

    def __init__(
        self, keypoints: Mapping[KeypointsKey, Sequence[Keypoints]], settings: LabelSettings
    ) -> None:
        """Use `keypoints`, by ('stamp', nanoseconds) or ('frame', number)."""
        self._keypoints = keypoints
        self._settings = settings
        self._stamps = np.array(
            sorted(value for kind, value in keypoints if kind == 'stamp'), np.int64
        )
        self._moments: list[int] = []
        self._used: set[KeypointsKey] = set()
        self._without_depth = 0

    @property
    def warnings(self) -> Sequence[str]:
        """A sentence on keypoints without depth, and on images without a frame."""
        unused = [key for key in self._keypoints if key not in self._used]
        stamps = [value for kind, value in unused if kind == 'stamp']
        others = len(unused) - len(stamps)
        numbered = f'the {len(self._moments)} depth images are numbered from 0'
        texts = (
            (self._without_depth, f'{self._without_depth} keypoints have no depth near them'),
            (len(stamps), self._far_stamps(stamps)),
            (
                others,
                f'{others} images with keypoints have the number of no depth image; {numbered}',
            ),
        )
        return [text for count, text in texts if count]

    def at(self, number: int, frame: Frame) -> Skeletons:
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        moment = frame.stamp - self._settings.time_offset
        self._moments.append(moment)
        key = self._key(number, moment)
        people = self._keypoints.get(key)
        if people is None:
            return skeletons_of({})
        self._used.add(key)
        return skeletons_of({person.body: self._joints(person.pixels, frame) for person in people})

    def why_none(self, number: int, frame: Frame) -> str:
        """Return why a frame has no label; as `LabelSource.why_none`."""
        key = self._key(number, frame.stamp - self._settings.time_offset)
        return 'without depth near any keypoint' if key in self._keypoints else 'without keypoints'

    def _key(self, number: int, moment: int) -> KeypointsKey:
        """Return that of the image with the nearest stamp, or else with the number."""
        place = nearest(self._stamps, moment)
        if place is not None and abs(int(self._stamps[place]) - moment) <= STAMP_TOLERANCE:
            return 'stamp', int(self._stamps[place])
        return 'frame', number

    def _far_stamps(self, stamps: Sequence[int]) -> str:
        """Return a sentence on images whose stamps are those of no depth image."""
        moments = np.array(sorted(self._moments), np.int64)
        places = [nearest(moments, stamp) for stamp in stamps]
        distances = [
            abs(int(moments[place]) - stamp)
            for place, stamp in zip(places, stamps, strict=True)
            if place is not None
        ]
        closest = min(distances, default=0)
        return (
            f'{len(stamps)} images with keypoints have no depth image within '
            f'{STAMP_TOLERANCE * 1e-6:g} ms of their stamp, the closest is '
            f'{closest * 1e-6:.1f} ms away; shift the stamps with --time-offset, or give the '
            'number of the depth image in the column frame'
        )

    def _joints(self, pixels: NDArray[np.float64], frame: Frame) -> NDArray[np.float64]:
        flat = np.concatenate([pixels, np.zeros((len(pixels), 1))], axis=1)
        ours = self._settings.vocabulary.ours(flat)[:, :2]
        depth = np.array([surface_depth(pixel, frame.depth) for pixel in ours])
        self._without_depth += int((np.isfinite(ours).all(axis=1) & np.isnan(depth)).sum())
        z = depth + SURFACE_TO_JOINT
        seen = np.asarray(np.isfinite(ours).all(axis=1))
        known = np.where(seen[:, None], ours, 0.0)
        directions = directions_of(known[:, 0], known[:, 1], frame.camera)
        joints = np.stack([directions[:, 0] * z, directions[:, 1] * z, z], axis=1)
        return np.where(seen[:, None], joints, np.nan)


def surface_depth(pixel: NDArray[np.float64], depth: NDArray[np.float32]) -> float:
    """Return the depth of the surface near a pixel (column, row), metres; NaN if there is none."""
    height, width = depth.shape
    if not np.isfinite(pixel).all() or np.abs(pixel).max() > LARGEST_PIXEL:
        return float('nan')
    column, row = (int(each) for each in np.rint(pixel))
    if not (0 <= column < width and 0 <= row < height):
        return float('nan')
    rows = slice(max(row - _RADIUS, 0), row + _RADIUS + 1)
    columns = slice(max(column - _RADIUS, 0), column + _RADIUS + 1)
    around = depth[rows, columns]
    around = around[np.isfinite(around) & (around > 0)]
    return float(np.quantile(around, _SURFACE_QUANTILE)) if around.size else float('nan')
