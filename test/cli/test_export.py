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

"""`lsc_pose export`: joints for other programs, and back."""

import csv
import io
import json
import os
import threading

import numpy as np
import pytest

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.body_frame import body_frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, PARENTS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.bvh_writer import bvh_text


@pytest.fixture(scope='module')
def frames():
    settings = SyntheticSettings(frames=8, seed=3, clip_length=8, rate=10.0)
    frames = list(synthetic_frames(settings))
    frames[3].ground_truth.positions[:, JOINT_NUMBERS['l_hand']] = np.nan
    frames[3].ground_truth.confidence[:, JOINT_NUMBERS['l_hand']] = 0
    return frames


@pytest.fixture
def recording(tmp_path, frames):
    path = tmp_path / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in frames:
            writer.write_frame(frame)
    return path


def export(recording, name, *options):
    output = recording.with_name(name)
    assert main(['export', str(recording), '-o', str(output), *options]) == 0
    return output


def test_csv_is_long_and_comes_back_as_labels(tmp_path, recording, frames):
    table = export(recording, 'joints.csv')
    with table.open(newline='') as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(frames) * len(JOINT_NAMES)
    assert list(rows[0]) == ['stamp', 'body', 'joint', 'x', 'y', 'z', 'confidence']
    assert [row['x'] for row in rows if row['joint'] == 'l_hand'].count('') == 1
    assert rows[0]['stamp'] == '1700000000.000000000'
    output = tmp_path / 'back.mcap'
    words = ['--from', 'csv', '--source', str(table), '--no-check']
    assert main(['label', str(recording), '-o', str(output), *words]) == 0
    for frame, true in zip(open_recording(output), frames, strict=True):
        np.testing.assert_allclose(
            frame.ground_truth.positions, true.ground_truth.positions, atol=1e-5
        )


def test_csv_is_wide_if_asked(recording, frames):
    with export(recording, 'joints.csv', '--wide').open(newline='') as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(frames)
    assert float(rows[2]['head_z']) == pytest.approx(
        frames[2].ground_truth.positions[0, 0, 2], abs=1e-5
    )


def test_npz(recording, frames):
    with np.load(export(recording, 'joints.npz')) as arrays:
        assert arrays['joints'].tolist() == list(JOINT_NAMES)
        assert arrays['stamps'].tolist() == [frame.stamp for frame in frames]
        expected = np.stack([frame.ground_truth.positions[0] for frame in frames])
        np.testing.assert_array_equal(arrays['positions'], expected)
        assert str(arrays['frame_id']) == frames[0].frame_id


def test_npz_through_a_pipe(recording, frames):
    path = recording.parent / 'pipe.npz'
    os.mkfifo(path)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()))
    reader.start()
    export(recording, 'pipe.npz')
    reader.join()
    with np.load(io.BytesIO(read[0])) as arrays:
        assert len(arrays['stamps']) == len(frames)


def test_json_has_null_for_unknown_joints(recording, frames):
    table = json.loads(export(recording, 'joints.json').read_text())
    assert [each['stamp_ns'] for each in table['bodies']] == [frame.stamp for frame in frames]
    hand = table['bodies'][3]['joints']['l_hand']
    assert hand == {'position': None, 'confidence': 0}
    assert table['frame_id'] == frames[0].frame_id


def test_parquet(recording, frames):
    parquet = pytest.importorskip('pyarrow.parquet')
    table = parquet.read_table(export(recording, 'joints.parquet'))
    assert table.num_rows == len(frames) * len(JOINT_NAMES)
    assert table['x'].null_count == 1
    assert table['stamp'].cast('int64')[0].as_py() == frames[0].stamp


def test_bvh_of_a_rigid_body_has_the_joints_where_they_are(recording, frames):
    bvh = load_bvh(export(recording, 'joints.bvh'))
    assert bvh.frame_time == pytest.approx(0.1)
    found = joint_poses(bvh).positions * 0.01 * (1, -1, -1)
    errors = []
    for place, frame in zip(found, frames, strict=True):
        true = frame.ground_truth.positions[0]
        errors.append(
            [np.linalg.norm(place[bvh.names.index(name)] - true[number])
             for number, name in enumerate(JOINT_NAMES)]
        )  # fmt: skip
    # Bones of the synthetic body are rigid, but its spine and shoulders bend within themselves.
    assert np.nanmedian(errors) < 0.02
    assert np.nanmax(errors) < 0.12


def rigid_body(count, seed):
    """A body whose joints hang together rigidly, but for elbows and knees; it turns and moves."""
    random = np.random.default_rng(seed)
    rest = {'pelvis': np.zeros(3), 'torso': np.array([0, -0.25, 0.02])}
    rest['neck'] = np.array([0, -0.5, 0.0])
    for name in JOINT_NAMES:
        if name not in rest:
            parent = PARENTS.get(name, 'pelvis')
            step = random.normal(0, 0.1, 3)
            rest[name] = rest[parent] + step if parent in rest else step
    rest['l_hip'], rest['r_hip'] = np.array([0.1, 0.05, 0]), np.array([-0.1, 0.05, 0])
    frames = []
    for number in range(count):
        angle = 0.2 * number
        turn = np.array([
            [np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)],
        ])  # fmt: skip
        joints = np.array([rest[name] for name in JOINT_NAMES])
        bend = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)],
                         [0, np.sin(angle), np.cos(angle)]])  # fmt: skip
        for end in ('l_wrist', 'l_hand'):
            elbow = rest['l_elbow']
            joints[JOINT_NUMBERS[end]] = elbow + bend @ (rest[end] - elbow)
        frames.append(joints @ turn.T + (0.1 * number, 0, 2.5))
    return np.array(frames)


@pytest.mark.parametrize('seed', range(3))
def test_bvh_is_exact_for_rigid_bones(tmp_path, seed):
    true = rigid_body(12, seed)
    path = tmp_path / 'rigid.bvh'
    path.write_text(bvh_text(true, 0.05))
    bvh = load_bvh(path)
    found = joint_poses(bvh).positions * 0.01 * (1, -1, -1)
    order = [bvh.names.index(name) for name in JOINT_NAMES]
    np.testing.assert_allclose(found[:, order], true, atol=2e-3)


def test_bvh_of_unknown_joints():
    joints = np.full((4, 20, 3), np.nan)
    with pytest.raises(ValueError, match='pelvis'):
        bvh_text(joints, 0.1)
    joints[:, [JOINT_NUMBERS['l_hip'], JOINT_NUMBERS['r_hip']]] = [[0.1, 0, 2], [-0.1, 0, 2]]
    text = bvh_text(joints, 0.1)
    assert 'l_hip' in text
    assert 'l_knee' not in text
    assert 'nan' not in text
    assert body_frame(np.arange(20, dtype=np.uint16), joints[0].astype('f4')) is not None


def test_unusable_exports_are_told(recording, capsys):
    def fails(name, *options):
        assert (
            main(['export', str(recording), '-o', str(recording.with_name(name)), *options]) == 2
        )
        return capsys.readouterr().err

    assert '.csv, .parquet' in fails('joints.xlsx')
    assert 'no body 5' in fails('joints.bvh', '--body', '5')
    assert 'TF does not know map' in fails('joints.csv', '--frame', 'map')


def test_skeletons_as_plain_numbers_and_as_a_structured_array():
    positions = np.array([[[0.5, 1, 2], [np.nan] * 3]], np.float32)
    confidence = np.array([[0.75, 0]], np.float32)
    skeletons = Skeletons(np.array([7], 'u2'), np.array([0, 3], 'u2'), positions, confidence)
    assert skeletons.to_dict() == {
        7: {
            'head': {'x': 0.5, 'y': 1.0, 'z': 2.0, 'confidence': 0.75},
            'pelvis': {'x': None, 'y': None, 'z': None, 'confidence': 0.0},
        }
    }
    json.dumps(skeletons.to_dict(), allow_nan=False)
    array = skeletons.to_array()
    assert array.shape == (1, 2)
    assert array['body'].tolist() == [[7, 7]]
    assert array['z'][0, 0] == 2
