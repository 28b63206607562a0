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

"""Imports UTD-MHAD (Chen, Jafari, Kehtarnavaz, ICIP 2015): real people in front of a Kinect v1.

The import corrects three properties of this data set that harm training:

- Images and X axis are mirrored: the person's right arm is at image right. Images are flipped,
  and positions (X, Y up, Z) become (-X, -Y, Z) in the optical frame of REP-103. The joint names
  left and right are already the person's own.
- The skeletons are two frames ahead of the depth images: depth image k belongs to skeleton k - 2.
  The first two depth images of a sequence are left out.
- The labels come from the tracker of the Kinect SDK, not from motion capture, and limbs are
  sometimes lost. A joint that projects more than 3 pixels outside the mask counts as unlabelled.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.datasets.utd_mhad_files import (
    FRAME_RATE,
    LAG,
    SECOND,
    ActionSequence,
    Selection,
    read_depth,
    select_sequences,
)

__all__ = ['LABEL_MARGIN', 'LAG', 'Selection', 'import_utd_mhad', 'near_mask', 'select_sequences']

LABEL_MARGIN = 3
"""Maximum distance between the projection of a labelled joint and the mask, pixels."""

FRAME_ID = 'camera_depth_optical_frame'
BODY = 1

# The data set contains no intrinsics. The Kinect SDK's nominal ones at 320x240 fit, as an overlay
# shows. The flip changes the principal column from 160 to 319 - 160.
CAMERA = Intrinsics(285.63, 285.63, 159.0, 120.0)

# The order of Skeleton_joint_order.txt, with our joint names.
JOINT_ORDER: tuple[str, ...] = (
    'head', 'neck', 'torso', 'pelvis',
    'l_shoulder', 'l_elbow', 'l_wrist', 'l_hand', 'r_shoulder', 'r_elbow', 'r_wrist', 'r_hand',
    'l_hip', 'l_knee', 'l_ankle', 'l_foot', 'r_hip', 'r_knee', 'r_ankle', 'r_foot',
)  # fmt: skip
_NUMBERS = [JOINT_NUMBERS[name] for name in JOINT_ORDER]


def import_utd_mhad(
    sequences: Sequence[ActionSequence], *, label_filter: bool = True
) -> Iterator[Frame]:
    """Import the frames that `select_sequences` found, with one sequence in memory at a time.

    Args:
        sequences: the sequences and their frames.
        label_filter: whether joints that project more than LABEL_MARGIN pixels outside the mask
            become unlabelled (NaN).

    Yields:
        The frames without mirroring and lag; stamps increase at the original 30 Hz.

    Raises:
        InputError: a depth file is unreadable or does not fit its skeletons.
    """
    for sequence in sequences:
        millimetres = read_depth(sequence)
        for index in sequence.frames:
            depth, positions = unmirror(
                millimetres[:, :, index], sequence.skeletons[:, :, index - LAG]
            )
            if label_filter:
                positions[~near_mask(positions, depth > 0)] = np.nan
            yield Frame(
                stamp=sequence.start + int(index) * SECOND // FRAME_RATE,
                frame_id=FRAME_ID,
                depth=depth,
                labels=np.where(depth > 0, BODY, NO_BODY).astype(np.int32),
                camera=CAMERA,
                ground_truth=_ground_truth(positions),
            )


def unmirror(
    millimetres: NDArray[np.uint16], skeleton: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Undo the mirroring of one frame.

    Args:
        millimetres: the depth image as stored, shape (H, W).
        skeleton: the joints as stored, metres, shape (20, 3).

    Returns:
        Depth in metres, flipped left-right, shape (H, W), and the joints in the optical frame in
        the order of JOINT_NAMES, metres, shape (20, 3).
    """
    depth = np.ascontiguousarray(millimetres[:, ::-1]).astype(np.float32) / np.float32(1000)
    positions = np.empty((len(JOINT_NAMES), 3), np.float32)
    positions[_NUMBERS] = skeleton * np.array([-1.0, -1.0, 1.0])
    return depth, positions


def near_mask(
    positions: NDArray[np.float32], mask: NDArray[np.bool_], margin: int = LABEL_MARGIN
) -> NDArray[np.bool_]:
    """Return which joints, shape (J, 3), project onto `mask` or within `margin` pixels of it."""
    height, width = mask.shape
    pixels = project(positions, CAMERA)
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


def _ground_truth(positions: NDArray[np.float32]) -> Skeletons:
    known: NDArray[np.bool_] = np.asarray(np.isfinite(positions).all(axis=1))
    return Skeletons(
        np.array([BODY], np.uint16),
        np.arange(len(JOINT_NAMES), dtype=np.uint16),
        positions[None],
        known.astype(np.float32)[None],
    )
