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

"""Frames as a camera sees them that is turned about its viewing axis."""

import numpy as np

from lsc_pose_ros.camera.transform_tree import FrameTransform, Rotation
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame

ROLLS = (0, 90, 180, 270)


def rolled(frame: Frame, roll: int) -> Frame:
    """Return what the camera of `frame` sees after it is turned clockwise, seen from behind.

    The image turns counter-clockwise, pixel by pixel. Without a lens.
    """
    depth, labels, truth = frame.depth, frame.labels, frame.ground_truth
    fx, fy, cx, cy = frame.camera[:4]
    for _ in range(roll // 90):
        # Column c becomes row W - 1 - c, and row r becomes column r.
        fx, fy, cx, cy = fy, fx, cy, depth.shape[1] - 1 - cx
        depth, labels = depth.T[::-1].copy(), labels.T[::-1].copy()
        if truth is not None:
            x, y, z = np.moveaxis(truth.positions, -1, 0)
            truth = truth._replace(positions=np.stack([y, -x, z], axis=-1))
    camera = Intrinsics(fx, fy, cx, cy)
    return frame._replace(depth=depth, labels=labels, camera=camera, ground_truth=truth)


def mounting(frame_id: str, roll: float, pitch: float = 0.0) -> list[FrameTransform]:
    """Return the transforms of a camera on a robot: base_link, camera_link, the optical frame.

    Args:
        frame_id: the optical frame.
        roll: clockwise about the viewing axis, seen from behind, degrees.
        pitch: downwards, degrees.
    """
    a, b = np.radians(roll) / 2, np.radians(pitch) / 2
    # x is forward: pitch about y, then roll about x. A positive turn about x is clockwise, seen
    # from behind.
    first, second = Rotation(0, np.sin(b), 0, np.cos(b)), Rotation(np.sin(a), 0, 0, np.cos(a))
    return [
        FrameTransform('base_link', 'camera_link', product(first, second)),
        FrameTransform('camera_link', frame_id, Rotation(-0.5, 0.5, -0.5, 0.5)),
    ]


def product(p: Rotation, q: Rotation) -> Rotation:
    """Return the quaternion product."""
    return Rotation(
        p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
        p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x,
        p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w,
        p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z,
    )
