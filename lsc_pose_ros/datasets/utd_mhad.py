"""Reads UTD-MHAD (Chen, Jafari, Kehtarnavaz, ICIP 2015): real people before a Kinect v1.

Three things about this data set are put right here, because each spoils whatever is trained on it:

- Its images and its X axis are mirrored: the person's right arm is at image right. Images are
  flipped, and positions (X, Y up, Z) become (-X, -Y, Z) in the optical frame of REP-103. The names
  left and right are the person's own already.
- Its skeletons are two frames ahead of its depth: depth k belongs to skeleton k - 2. The first
  two depth images of a sequence are left out.
- Its labels are the Kinect SDK's tracker, not motion capture, and now and then a limb is lost: a
  joint that projects more than 3 pixels outside the mask is taken as not labelled.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics, project
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.datasets.utd_mhad_files import (
    FRAME_RATE,
    LAG,
    SECOND,
    Selection,
    Take,
    read_depth,
    select_takes,
)

__all__ = ['LABEL_MARGIN', 'LAG', 'Selection', 'import_utd_mhad', 'near_mask', 'select_takes']

LABEL_MARGIN = 3
"""How many pixels outside the mask a joint may project and still count as labelled."""

FRAME_ID = 'camera_depth_optical_frame'
BODY = 1

# The data set gives no intrinsics. The Kinect SDK's nominal ones at 320x240 fit by overlay; its
# principal column 160 becomes 319 - 160 by the flip.
CAMERA = Intrinsics(285.63, 285.63, 159.0, 120.0)

# Skeleton_joint_order.txt in our vocabulary.
JOINT_ORDER: tuple[str, ...] = (
    'head', 'neck', 'torso', 'pelvis',
    'l_shoulder', 'l_elbow', 'l_wrist', 'l_hand', 'r_shoulder', 'r_elbow', 'r_wrist', 'r_hand',
    'l_hip', 'l_knee', 'l_ankle', 'l_foot', 'r_hip', 'r_knee', 'r_ankle', 'r_foot',
)  # fmt: skip
_NUMBERS = [JOINT_NUMBERS[name] for name in JOINT_ORDER]


def import_utd_mhad(takes: Sequence[Take], *, label_filter: bool = True) -> Iterator[Frame]:
    """Read the frames that `select_takes` found, one sequence in memory at a time.

    Args:
        takes: the sequences and their frames.
        label_filter: take a joint that projects more than LABEL_MARGIN pixels outside the mask
            as not labelled (NaN).

    Yields:
        The frames, un-mirrored and with the lag taken out; stamps rise at the original 30 Hz.

    Raises:
        InputError: a depth file is unreadable or does not fit its skeletons.
    """
    for take in takes:
        millimetres = read_depth(take)
        for index in take.frames:
            depth, positions = upright(millimetres[:, :, index], take.skeletons[:, :, index - LAG])
            if label_filter:
                positions[~near_mask(positions, depth > 0)] = np.nan
            yield Frame(
                stamp=take.start + int(index) * SECOND // FRAME_RATE,
                frame_id=FRAME_ID,
                depth=depth,
                labels=np.where(depth > 0, BODY, NO_BODY).astype(np.int32),
                camera=CAMERA,
                ground_truth=_ground_truth(positions),
            )


def upright(
    millimetres: NDArray[np.uint16], skeleton: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Undo the mirroring of one frame.

    Args:
        millimetres: the depth image as stored, shape (H, W).
        skeleton: the joints as stored, metres, shape (20, 3).

    Returns:
        Depth in metres, flipped left-right, shape (H, W), and the joints in the optical frame in
        the vocabulary's order, metres, shape (20, 3).
    """
    depth = np.ascontiguousarray(millimetres[:, ::-1]).astype(np.float32) / np.float32(1000)
    positions = np.empty((len(JOINT_NAMES), 3), np.float32)
    positions[_NUMBERS] = skeleton * np.array([-1.0, -1.0, 1.0])
    return depth, positions


def near_mask(
    positions: NDArray[np.float32], mask: NDArray[np.bool_], margin: int = LABEL_MARGIN
) -> NDArray[np.bool_]:
    """Tell which joints, shape (J, 3), project onto `mask` or within `margin` pixels of it."""
    height, width = mask.shape
    pixels = project(positions, CAMERA)
    seen: NDArray[np.bool_] = np.asarray(np.isfinite(pixels).all(axis=1))
    # Far outside is outside: clipping keeps the numbers within int32 whatever the label.
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
