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

"""Writes the joints of one body as a BVH file, for animation programs.

The bones have constant lengths, the medians of those of the body, and rotate. The axes of the file
are those of animation programs: x to the right of the image, y up, z towards the camera; its unit
is the centimetre.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.body_frame import body_frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS

CENTIMETRES = 100.0
ROOT = 'pelvis'

# From the optical frame to the axes of the file.
_TO_FILE = np.array([1.0, -1.0, -1.0])

# From the axes of the body (forward, left, up) to those of the file, for a person who looks along
# z: x is the person's left.
_BODY_TO_FILE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])

_PARENTS: Mapping[str, str] = {
    'torso': 'pelvis', 'neck': 'torso', 'head': 'neck',
    'l_shoulder': 'neck', 'l_elbow': 'l_shoulder', 'l_wrist': 'l_elbow', 'l_hand': 'l_wrist',
    'r_shoulder': 'neck', 'r_elbow': 'r_shoulder', 'r_wrist': 'r_elbow', 'r_hand': 'r_wrist',
    'l_hip': 'pelvis', 'l_knee': 'l_hip', 'l_ankle': 'l_knee', 'l_foot': 'l_ankle',
    'r_hip': 'pelvis', 'r_knee': 'r_hip', 'r_ankle': 'r_knee', 'r_foot': 'r_ankle',
}  # fmt: skip

# The directions of bones in the rest pose, a T, where they are not measured.
_REST = {
    'neck': (0, 1, 0), 'l_elbow': (1, 0, 0), 'l_wrist': (1, 0, 0), 'l_hand': (1, 0, 0),
    'r_elbow': (-1, 0, 0), 'r_wrist': (-1, 0, 0), 'r_hand': (-1, 0, 0),
    'l_knee': (0, -1, 0), 'l_ankle': (0, -1, 0), 'l_foot': (0, 0, 1),
    'r_knee': (0, -1, 0), 'r_ankle': (0, -1, 0), 'r_foot': (0, 0, 1),
}  # fmt: skip

_NO_LENGTH = 1e-9


class _Skeleton(NamedTuple):
    """The joints of a file: their names, parents first, and their children and rest offsets."""

    names: list[str]
    children: dict[str, list[str]]
    offsets: dict[str, NDArray[np.float64]]


def bvh_text(positions: NDArray[np.floating], frame_time: float) -> str:
    """Return the text of a BVH file.

    Args:
        positions: the joints of one body in the optical frame, metres, NaN if unknown, shape
            (T, 20, 3). A joint that is unknown for some frames keeps its rotation; one that is
            never known is left out, with what hangs on it.
        frame_time: seconds.

    Raises:
        ValueError: the pelvis is never known, nor are both hips.
    """
    file_positions = _completed(positions.astype(np.float64))
    skeleton = _skeleton(file_positions)
    rows = _motion(skeleton, CENTIMETRES * _TO_FILE * file_positions)
    lines = ['HIERARCHY', *_hierarchy(skeleton, ROOT, 0), 'MOTION', f'Frames: {len(rows)}']
    lines.append(f'Frame Time: {frame_time:.9f}')
    lines += [' '.join(f'{value:.6f}' for value in row) for row in rows]
    return '\n'.join(lines) + '\n'


def _completed(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the joints with a pelvis in each frame: midway between the hips if it is unknown."""
    pelvis = JOINT_NUMBERS[ROOT]
    hips = positions[:, [JOINT_NUMBERS['l_hip'], JOINT_NUMBERS['r_hip']]].mean(axis=1)
    positions = positions.copy()
    unknown = np.isnan(positions[:, pelvis]).any(axis=1)
    positions[unknown, pelvis] = hips[unknown]
    known = np.flatnonzero(np.isfinite(positions[:, pelvis]).all(axis=1))
    if not len(known):
        msg = 'neither the pelvis nor both hips are known in any frame'
        raise ValueError(msg)
    # The last known place before a gap, the first one at the beginning.
    latest = np.maximum.accumulate(
        np.where(np.isin(np.arange(len(positions)), known), np.arange(len(positions)), known[0])
    )
    positions[:, pelvis] = positions[latest, pelvis]
    return positions


def _skeleton(positions: NDArray[np.float64]) -> _Skeleton:
    names = [ROOT]
    children: dict[str, list[str]] = {ROOT: []}
    offsets = {ROOT: np.zeros(3)}
    frames = [body_frame(np.arange(20, dtype=np.uint16), each.astype('f4')) for each in positions]
    for name, parent in _PARENTS.items():
        if parent not in children:
            continue
        bones = positions[:, JOINT_NUMBERS[name]] - positions[:, JOINT_NUMBERS[parent]]
        known = np.asarray(np.isfinite(bones).all(axis=1))
        if not known.any():
            continue
        names.append(name)
        children[name] = []
        children[parent].append(name)
        direction = np.array(_REST.get(name, (0, 0, 0)), np.float64)
        if name not in _REST:
            inside = [
                _BODY_TO_FILE @ frame.axes.T @ bone
                for frame, bone, seen in zip(frames, bones, known, strict=True)
                if seen and frame is not None
            ]
            direction = np.mean(inside, axis=0) if inside else np.array([0.0, 1.0, 0.0])
        length = float(np.median(np.linalg.norm(bones[known], axis=1)))
        norm = max(float(np.linalg.norm(direction)), _NO_LENGTH)
        offsets[name] = CENTIMETRES * length * direction / norm
    return _Skeleton(names, children, offsets)


def _hierarchy(skeleton: _Skeleton, name: str, depth: int) -> list[str]:
    indent = '  ' * depth
    offset = ' '.join(f'{value:.6f}' for value in skeleton.offsets[name])
    places = '6 Xposition Yposition Zposition' if name == ROOT else '3'
    lines = [
        f'{indent}{"ROOT" if name == ROOT else "JOINT"} {name}',
        f'{indent}{{',
        f'{indent}  OFFSET {offset}',
        f'{indent}  CHANNELS {places} Zrotation Xrotation Yrotation',
    ]
    for child in skeleton.children[name]:
        lines += _hierarchy(skeleton, child, depth + 1)
    if not skeleton.children[name]:
        end = f'{indent}  End Site', f'{indent}  {{', f'{indent}    OFFSET 0 0 0', f'{indent}  }}'
        lines += end
    return [*lines, f'{indent}}}']


def _motion(skeleton: _Skeleton, positions: NDArray[np.float64]) -> list[list[float]]:
    order = _depth_first(skeleton, ROOT)
    locals_ = {name: np.eye(3) for name in order}
    rows = []
    for joints in positions:
        turned: dict[str, NDArray[np.float64]] = {}
        row = joints[JOINT_NUMBERS[ROOT]].tolist()
        for name in order:
            above = turned[_PARENTS[name]] if name in _PARENTS else np.eye(3)
            fitted = _fitted(skeleton, name, joints, above)
            if fitted is not None:
                locals_[name] = above.T @ fitted
            turned[name] = above @ locals_[name]
            row += _zxy_degrees(locals_[name])
        rows.append(row)
    return rows


def _depth_first(skeleton: _Skeleton, name: str) -> list[str]:
    return [
        name,
        *(each for child in skeleton.children[name] for each in _depth_first(skeleton, child)),
    ]


def _fitted(
    skeleton: _Skeleton, name: str, joints: NDArray[np.float64], above: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return the rotation of a joint that turns its bones to where they are; None if unknown."""
    bones = {
        child: joints[JOINT_NUMBERS[child]] - joints[JOINT_NUMBERS[name]]
        for child in skeleton.children[name]
    }
    seen = [child for child, bone in bones.items() if np.isfinite(bone).all()]
    if not seen or (len(seen) < len(bones) and len(seen) < 2):
        return None
    rest = np.array([skeleton.offsets[child] for child in seen])
    there = np.array([bones[child] for child in seen])
    if len(seen) > 1:
        return _kabsch(rest, there)
    return _shortest_turn(above @ rest[0], there[0]) @ above


def _kabsch(rest: NDArray[np.float64], there: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation that turns vectors best to others (Kabsch 1976), both (n, 3)."""
    u, _, v = np.linalg.svd(rest.T @ there)
    sign = np.sign(np.linalg.det(u @ v)) or 1.0
    return np.asarray(v.T @ np.diag([1.0, 1.0, sign]) @ u.T)


def _shortest_turn(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation by the smallest angle that turns one direction to another."""
    a = first / max(float(np.linalg.norm(first)), _NO_LENGTH)
    b = second / max(float(np.linalg.norm(second)), _NO_LENGTH)
    axis, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1 + 1e-9:  # opposite: about any axis across
        across = np.cross(a, np.eye(3)[int(np.abs(a).argmin())])
        across /= np.linalg.norm(across)
        return np.asarray(2 * np.outer(across, across) - np.eye(3))
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1 + cosine))


def _zxy_degrees(rotation: NDArray[np.float64]) -> list[float]:
    """Return the angles of R = R_z R_x R_y, degrees."""
    x = np.arcsin(np.clip(rotation[2, 1], -1, 1))
    z = np.arctan2(-rotation[0, 1], rotation[1, 1])
    y = np.arctan2(-rotation[2, 0], rotation[2, 2])
    return np.degrees([z, x, y]).tolist()  # type: ignore[no-any-return]
