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

"""Tests the BVH reader: hierarchy, channels in any order, damaged files."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from stick_figure import JOINTS, NAMES, bvh_text

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh

SMALL = """HIERARCHY
ROOT hip
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation
  JOINT knee
  {
    OFFSET 0 -2 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -1 0.5
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
1 2 3 0 0 0 90

4 5 6 90 0 0 0
"""


def write(tmp_path, text):
    path = tmp_path / 'clip.bvh'
    path.write_bytes(text.encode('latin-1'))
    return path


def test_small_file_is_read(tmp_path):
    bvh = load_bvh(write(tmp_path, SMALL))
    assert bvh.names == ('hip', 'knee', 'knee_end')
    assert bvh.parents == (-1, 0, 1)
    assert bvh.channels[1:] == (('Xrotation',), ())
    assert bvh.frame_time == 0.04
    np.testing.assert_array_equal(bvh.offsets, [[0, 0, 0], [0, -2, 0], [0, -1, 0.5]])
    np.testing.assert_array_equal(bvh.values[1], [4, 5, 6, 90, 0, 0, 0])


def test_joint_positions_agree_with_a_manual_calculation(tmp_path):
    placed = joint_poses(load_bvh(write(tmp_path, SMALL)))
    # Frame 1: the knee rotates by 90 degrees about x, which maps -y to -z and z to -y.
    expected = [[1, 2, 3], [1, 0, 3], [1, -0.5, 2]]
    np.testing.assert_allclose(placed.positions[0], expected, atol=1e-12)
    # Frame 2: all joints rotate by 90 degrees about y, which maps z to x.
    expected = [[4, 5, 6], [4, 3, 6], [4.5, 2, 6]]
    np.testing.assert_allclose(placed.positions[1], expected, atol=1e-12)


@pytest.mark.parametrize('order', ['ZXY', 'XYZ', 'YXZ', 'ZYX'])
def test_rotations_agree_with_scipy_for_any_order_of_channels(tmp_path, order):
    random = np.random.default_rng(3)
    frames = [
        {name: Rotation.random(random_state=int(random.integers(1000))) for name in NAMES}
        for _ in range(4)
    ]
    bvh = load_bvh(write(tmp_path, bvh_text(frames, order=order)))
    placed = joint_poses(bvh)
    for number, frame in enumerate(frames):
        orientations, places = {}, {}
        for name, parent, offset in JOINTS:
            above = orientations[parent] if parent else Rotation.identity()
            places[name] = (places[parent] if parent else 0) + above.apply(offset)
            orientations[name] = above * frame[name]
            joint = bvh.names.index(name)
            found = placed.orientations[number, joint]
            np.testing.assert_allclose(found, orientations[name].as_matrix(), atol=1e-5)
            np.testing.assert_allclose(placed.positions[number, joint], places[name], atol=1e-5)


def test_windows_line_ends_tabs_and_8_bit_code_pages_are_read(tmp_path):
    text = SMALL.replace('\n', '\r\n').replace('  ', '\t').replace('knee', 'knie\xe9')
    assert load_bvh(write(tmp_path, text)).names[1] == 'knie\xe9'


@pytest.mark.parametrize(
    ('old', 'new', 'line', 'says'),
    [
        ('HIERARCHY', 'NONSENSE', 1, "'NONSENSE' found, but HIERARCHY is expected"),
        ('ROOT hip', 'JOINT hip', 2, 'ROOT is expected'),
        ('ROOT hip', 'ROOT', 2, 'no name'),
        ('OFFSET 0 -2 0', 'OFFSET 0 -2', 8, '2 numbers'),
        ('OFFSET 0 -2 0', 'OFFSET 0 -2 nan', 8, 'not finite'),
        ('OFFSET 0 -2 0', 'OFFSET 0 two 0', 8, 'two'),
        ('CHANNELS 1 Xrotation', 'CHANNELS 2 Xrotation', 9, '1 channels found, but 2'),
        ('CHANNELS 1 Xrotation', 'CHANNELS', 9, 'their number is expected'),
        ('CHANNELS 1 Xrotation', 'CHANNELS 1 Wrotation', 9, 'Wrotation'),
        ('JOINT knee', 'JOINT hip', 9, 'second joint hip'),
        ('JOINT knee', 'JIONT knee', 6, 'JIONT'),
        ('MOTION', '}', 16, 'MOTION is expected'),
        ('Frames: 2', 'Frames: 3', 21, '2 frames instead of 3'),
        ('Frame Time: 0.04', 'Frame Time: 0', 18, 'lasts 0 s'),
        ('4 5 6 90 0 0 0', '4 5 6 90 0 0', 21, '6 numbers found, but 7'),
        ('4 5 6 90 0 0 0', '4 5 6 90 0 0 x', 21, 'could not convert'),
    ],
)
def test_damage_is_reported_with_its_line(tmp_path, old, new, line, says):
    path = write(tmp_path, SMALL.replace(old, new, 1))
    with pytest.raises(InputError, match=rf'clip.bvh, line {line}: .*{says}'):
        load_bvh(path)


@pytest.mark.parametrize('lines', [0, 5, 10, 15, 16, 17, 18, 20])
def test_truncated_file_is_refused(tmp_path, lines):
    with pytest.raises(InputError, match=r'clip.bvh, line'):
        load_bvh(write(tmp_path, '\n'.join(SMALL.splitlines()[:lines])))


def test_missing_file_is_reported(tmp_path):
    with pytest.raises(InputError, match=r'nothing\.bvh'):
        load_bvh(tmp_path / 'nothing.bvh')
