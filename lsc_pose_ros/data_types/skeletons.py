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

"""The skeletons of one frame, and their points in a PointCloud2."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of

# One point of `~/skeletons`: little endian, no padding.
POINT_DTYPE = np.dtype(
    [
        ('x', '<f4'),
        ('y', '<f4'),
        ('z', '<f4'),
        ('confidence', '<f4'),
        ('body', '<u2'),
        ('joint', '<u2'),
    ]
)

# One point of `ground_truth/skeletons`, if the visibility of the joints is known.
GROUND_TRUTH_DTYPE = np.dtype(
    {
        'names': [*(POINT_DTYPE.names or ()), 'visibility'],
        'formats': ['<f4', '<f4', '<f4', '<f4', '<u2', '<u2', 'u1'],
        'offsets': [0, 4, 8, 12, 16, 18, 20],
        'itemsize': 24,
    }
)


class Skeletons(NamedTuple):
    """The bodies of one frame: B bodies, each with the same J joints.

    Attributes:
        bodies: the number of each body, shape (B,): the value of its mask pixels.
        joints: the number of each joint, an index into JOINT_NAMES, shape (J,).
        positions: metres in the camera's optical frame, NaN if unknown, shape (B, J, 3).
        confidence: the probability that the joint is within 10 cm of its true position, 0 if the
            joint is unknown, shape (B, J).
        visibility: whether the camera sees each joint, or what hides it, as in
            `lsc_pose_ros.data_types.visibility`, shape (B, J); only in ground truth, None if it
            is not known.
    """

    bodies: NDArray[np.uint16]
    joints: NDArray[np.uint16]
    positions: NDArray[np.float32]
    confidence: NDArray[np.float32]
    visibility: NDArray[np.uint8] | None = None

    def to_dict(self) -> dict[int, dict[str, dict[str, float | None]]]:
        """Return the bodies as plain numbers, for JSON and notebooks.

        Returns:
            By body number and joint name: x, y, z in metres and confidence; None if unknown.
        """
        return {
            int(body): {
                name: {
                    **{
                        axis: float(value) if np.isfinite(value) else None
                        for axis, value in zip('xyz', position, strict=True)
                    },
                    'confidence': float(confidence),
                }
                for name, position, confidence in zip(
                    names_of(self.joints), positions, confidences, strict=True
                )
            }
            for body, positions, confidences in zip(
                self.bodies, self.positions, self.confidence, strict=True
            )
        }

    def to_array(self) -> NDArray[np.void]:
        """Return a structured array, shape (B, J): x, y, z, confidence, body and joint number.

        It also has the visibility, if that is known. `pandas.DataFrame(array.ravel())` makes a
        table of it.
        """
        return pack(self)


def no_skeletons(joints: NDArray[np.uint16]) -> Skeletons:
    """Return the skeletons of a frame without bodies."""
    count = len(joints)
    return Skeletons(
        np.zeros(0, np.uint16),
        joints,
        np.zeros((0, count, 3), np.float32),
        np.zeros((0, count), np.float32),
    )


def known_bodies(skeletons: Skeletons) -> int:
    """Return how many bodies have a joint that is known."""
    return int(np.isfinite(skeletons.positions).all(axis=-1).any(axis=-1).sum())


def pack(skeletons: Skeletons) -> NDArray[np.void]:
    """Return `skeletons` as an organised cloud, shape (B, J).

    Its points are those of POINT_DTYPE, or of GROUND_TRUTH_DTYPE with the visibility.
    """
    visibility = skeletons.visibility
    dtype = POINT_DTYPE if visibility is None else GROUND_TRUTH_DTYPE
    points = np.zeros(skeletons.confidence.shape, dtype)
    if visibility is not None:
        points['visibility'] = visibility
    for axis, name in enumerate('xyz'):
        points[name] = skeletons.positions[..., axis]
    points['confidence'] = skeletons.confidence
    points['body'] = skeletons.bodies[:, None]
    points['joint'] = skeletons.joints[None, :]
    return points


def unpack(points: NDArray[np.void]) -> Skeletons:
    """Return the skeletons in a cloud, shape (B, J): the inverse of `pack`."""
    positions = np.stack([points['x'], points['y'], points['z']], axis=-1).astype(np.float32)
    joints = points['joint'][0] if len(points) else np.zeros(points.shape[1], np.uint16)
    bodies = points['body'][:, 0] if points.shape[1] else np.zeros(len(points), np.uint16)
    return Skeletons(
        bodies.astype(np.uint16),
        joints.astype(np.uint16),
        positions,
        points['confidence'].astype(np.float32),
        points['visibility'].astype(np.uint8)
        if 'visibility' in (points.dtype.names or ())
        else None,
    )
