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
from functools import cache

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
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
from lsc_pose_ros.labels.checks.problems import (
    OUTSIDE,
    LabelLimits,
    find_problems,
    without_problems,
)
from lsc_pose_ros.labels.vocabulary import Vocabulary, load_vocabulary

__all__ = ['LABEL_MARGIN', 'LAG', 'Selection', 'import_utd_mhad', 'select_sequences']

LABEL_MARGIN = 3
"""Maximum distance between the projection of a labelled joint and the mask, pixels."""

FRAME_ID = 'camera_depth_optical_frame'
BODY = 1

# The data set contains no intrinsics. The Kinect SDK's nominal ones at 320x240 fit, as an overlay
# shows. The flip changes the principal column from 160 to 319 - 160.
CAMERA = Intrinsics(285.63, 285.63, 159.0, 120.0)

_LIMITS = LabelLimits(margin=LABEL_MARGIN)

# Skeleton_joint_order.txt has the joints of the Kinect SDK in another order, with the names head,
# shoulder center, spine, hip center, left shoulder, ...
KINECT_ORDER: tuple[str, ...] = (
    'HEAD', 'SHOULDER_CENTER', 'SPINE', 'HIP_CENTER',
    'SHOULDER_LEFT', 'ELBOW_LEFT', 'WRIST_LEFT', 'HAND_LEFT',
    'SHOULDER_RIGHT', 'ELBOW_RIGHT', 'WRIST_RIGHT', 'HAND_RIGHT',
    'HIP_LEFT', 'KNEE_LEFT', 'ANKLE_LEFT', 'FOOT_LEFT',
    'HIP_RIGHT', 'KNEE_RIGHT', 'ANKLE_RIGHT', 'FOOT_RIGHT',
)  # fmt: skip


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
            frame = Frame(
                stamp=sequence.start + int(index) * SECOND // FRAME_RATE,
                frame_id=FRAME_ID,
                depth=depth,
                labels=np.where(depth > 0, BODY, NO_BODY).astype(np.int32),
                camera=CAMERA,
                ground_truth=_ground_truth(positions),
            )
            yield _filtered(frame) if label_filter else frame


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
    vocabulary, order = _kinect_joints()
    positions = vocabulary.ours(skeleton[order] * np.array([-1.0, -1.0, 1.0]))
    return depth, positions.astype(np.float32)


@cache
def _kinect_joints() -> tuple[Vocabulary, list[int]]:
    """Return the joints of the Kinect, and where each of them is in a skeleton as stored."""
    vocabulary = load_vocabulary('kinect_v1')
    return vocabulary, [KINECT_ORDER.index(name) for name in vocabulary.names]


def _filtered(frame: Frame) -> Frame:
    """Return `frame` without the labels that are outside of the mask."""
    labels = frame.ground_truth
    if labels is None:
        return frame
    problems = find_problems(frame, labels, _LIMITS)
    return frame._replace(ground_truth=without_problems(labels, problems, [OUTSIDE]))


def _ground_truth(positions: NDArray[np.float32]) -> Skeletons:
    known: NDArray[np.bool_] = np.asarray(np.isfinite(positions).all(axis=1))
    return Skeletons(
        np.array([BODY], np.uint16),
        np.arange(len(JOINT_NAMES), dtype=np.uint16),
        positions[None],
        known.astype(np.float32)[None],
    )
