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

"""`lsc_pose export` in a frame of TF, from recordings with TF that these tests write."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[1] / 'bags'))

from label_recordings import (
    CAMERA_FRAME,
    FRAMES,
    START,
    TF_MESSAGE,
    frame,
    pose,
    stamps,
    tf,
    transform,
)

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.labels.tracks import skeletons_of

# The camera is turned by a quarter about z on a base that moves evenly in the map.
CAMERA_ON_BASE = (0.5, -0.25, 1.0)
QUARTER = (0, 0, np.sqrt(0.5), np.sqrt(0.5))
TURN = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
SPEED = np.array([2.0, 1.0, 0.0])
LAST = START + (FRAMES - 2) * 100_000_000


def labelled(stamp: int):
    moment = (stamp - START) * 1e-9
    return frame(stamp)._replace(ground_truth=skeletons_of({1: pose(moment)}))


@pytest.fixture
def recording(tmp_path):
    """TF knows the base at the first and at the last but one frame; the last frame is later."""
    path = tmp_path / 'moving.mcap'
    static = transform(START, 'base', CAMERA_FRAME, CAMERA_ON_BASE, QUARTER)
    messages = [
        tf(START, [static], '/tf_static'),
        tf(START, [transform(START, 'map', 'base', (0, 0, 0))]),
        tf(LAST, [transform(LAST, 'map', 'base', SPEED * (LAST - START) * 1e-9)]),
    ]
    with RecordingWriter(path) as writer:
        for topic, kind, stamp, data in messages:
            assert kind == TF_MESSAGE
            writer.write(topic, kind, stamp, data)
        for stamp in stamps():
            writer.write_frame(labelled(stamp))
    return path


def test_positions_in_a_frame_that_moves(recording, capsys):
    output = recording.with_name('joints.npz')
    assert main(['export', str(recording), '-o', str(output), '--frame', 'map']) == 0
    printed = capsys.readouterr()
    assert 'warning: 1 bodies were left out: TF does not know map' in printed.err
    assert 'in map' in printed.out
    with np.load(output) as arrays:
        assert str(arrays['frame_id']) == 'map'
        assert arrays['joints'].tolist() == list(JOINT_NAMES)
        assert arrays['stamps'].tolist() == stamps()[:-1]
        for stamp, positions in zip(arrays['stamps'], arrays['positions'], strict=True):
            moment = (stamp - START) * 1e-9
            expected = pose(moment) @ TURN.T + CAMERA_ON_BASE + SPEED * moment
            # The skeletons are float32: 2 m to 2e-7.
            np.testing.assert_allclose(positions, expected, atol=1e-6)


def test_without_a_frame_positions_are_the_cameras(recording):
    output = recording.with_name('joints.npz')
    assert main(['export', str(recording), '-o', str(output)]) == 0
    with np.load(output) as arrays:
        assert str(arrays['frame_id']) == CAMERA_FRAME
        np.testing.assert_allclose(arrays['positions'][0], pose(0), atol=1e-6)
        assert len(arrays['stamps']) == FRAMES


def test_a_wide_parquet_table_has_a_row_for_each_body(recording):
    parquet = pytest.importorskip('pyarrow.parquet')
    output = recording.with_name('joints.parquet')
    words = ['export', str(recording), '-o', str(output), '--wide', '--frame', 'base']
    assert main(words) == 0
    table = parquet.read_table(output)
    assert table.num_rows == FRAMES
    expected = pose(0) @ TURN.T + CAMERA_ON_BASE
    for axis, name in enumerate('xyz'):
        found = table[f'head_{name}'][0].as_py()
        assert found == pytest.approx(expected[0, axis], abs=1e-6)


def test_skeletons_in_several_frames_need_one(tmp_path, capsys):
    path = tmp_path / 'two.mcap'
    with RecordingWriter(path) as writer:
        writer.write_frame(labelled(START))
        writer.write_frame(labelled(stamps()[1])._replace(frame_id='other_camera'))
    assert main(['export', str(path), '-o', str(tmp_path / 'joints.csv')]) == 2
    complaint = capsys.readouterr().err
    assert f'in the frames {CAMERA_FRAME} and other_camera; choose one with --frame' in complaint
