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

"""BVH files of a stick figure in T-pose, written for the tests."""

import numpy as np

# Name, parent, offset from the parent: x to the left, y up, z forward; a T-pose of 1.6 units.
JOINTS = (
    ('Hips', None, (0, 0, 0)),
    ('Spine', 'Hips', (0, 0.15, 0)),
    ('Chest', 'Spine', (0, 0.15, 0)),
    ('Head', 'Chest', (0, 0.25, 0)),
    *(
        (side + name, side + parent if parent.islower() else parent, (sign * x, y, z))
        for side, sign in (('Left', 1), ('Right', -1))
        for name, parent, (x, y, z) in (
            ('arm', 'Chest', (0.2, 0.2, 0)),
            ('elbow', 'arm', (0.3, 0, 0)),
            ('wrist', 'elbow', (0.25, 0, 0)),
            ('leg', 'Hips', (0.1, 0, 0)),
            ('knee', 'leg', (0, -0.4, 0)),
            ('ankle', 'knee', (0, -0.4, 0)),
        )
    ),
)
NAMES = [name for name, _, _ in JOINTS]

CROOKED = 0.0
"""Angle by which the forearms point forward in the T-pose, radians."""

BENT = ''
"""The corresponding entry of the mapping."""

MAPPING = """
axes: {up: UP, forward: FORWARD}
segments:
  pelvis: {turns: Hips}
  waist: {turns: Spine}
  chest: {turns: Chest}
  head: {turns: Head}
  l_upper_arm: {along: [Leftarm, Leftelbow]}
  l_forearm: {along: [Leftelbow, Leftwrist]BENT}
  l_hand: {turns: Leftwrist, at_rest: [0, 0, 90]}
  l_thigh: {along: [Leftleg, Leftknee]}
  l_shank: {along: [Leftknee, Leftankle]}
  l_foot: {turns: Leftankle}
  r_upper_arm: {along: [Rightarm, Rightelbow]}
  r_forearm: {along: [Rightelbow, Rightwrist]BENT}
  r_hand: {turns: Rightwrist, at_rest: [0, 0, -90]}
  r_thigh: {along: [Rightleg, Rightknee]}
  r_shank: {along: [Rightknee, Rightankle]}
  r_foot: {turns: Rightankle}
"""


def mapping_text(up='y', forward='z', extra=''):
    text = MAPPING.replace('UP', up).replace('FORWARD', forward).replace('BENT', BENT)
    return text + extra


def bvh_text(frames, axes=None, order='ZXY', frame_time=1 / 30):
    """Return a BVH file of the figure.

    Args:
        frames: for each frame, a scipy Rotation by the joint's name, in the person's axes; others
            are not turned.
        axes: the person's left, up and forward as rows in the file's axes.
        order: of the rotation channels.
        frame_time: seconds.
    """
    axes = np.eye(3) if axes is None else np.asarray(axes, float)
    lines = ['HIERARCHY']
    order_in_file = []
    _write_joint(lines, order_in_file, 'Hips', axes, order)
    lines += ['MOTION', f'Frames: {len(frames)}', f'Frame Time: {frame_time:.6f}']
    for frame in frames:
        values = [0.0, 0.0, 0.0]
        for name in order_in_file:
            if name in frame:
                turn = axes.T @ frame[name].as_matrix() @ axes
                values += list(type(frame[name]).from_matrix(turn).as_euler(order, degrees=True))
            else:
                values += [0.0, 0.0, 0.0]
        lines.append(' '.join(f'{value:.6f}' for value in values))
    return '\n'.join(lines) + '\n'


def _write_joint(lines, order_in_file, name, axes, order):
    _, parent, offset = JOINTS[NAMES.index(name)]
    if name.endswith('wrist'):
        length = offset[0]
        offset = (length * np.cos(CROOKED), 0, abs(length) * np.sin(CROOKED))
    order_in_file.append(name)
    channels = [f'{axis}rotation' for axis in order]
    if parent is None:
        channels = ['Xposition', 'Yposition', 'Zposition', *channels]
    lines += [f'{"JOINT" if parent else "ROOT"} {name}', '{', _offset(offset, axes)]
    lines.append(f'CHANNELS {len(channels)} {" ".join(channels)}')
    children = [child for child, above, _ in JOINTS if above == name]
    for child in children:
        _write_joint(lines, order_in_file, child, axes, order)
    if not children:
        lines += ['End Site', '{', _offset((0, 0, 0.1), axes), '}']
    lines.append('}')


def _offset(offset, axes):
    return 'OFFSET ' + ' '.join(f'{value:.6f}' for value in np.asarray(offset, float) @ axes)
