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

"""`lsc_pose info`."""

import argparse
import json
import re

import numpy as np
import pytest

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.commands import info_command
from lsc_pose_ros.data_types.skeletons import no_skeletons
from lsc_pose_ros.errors import InputError


def info(*words):
    parser = argparse.ArgumentParser()
    info_command.add_arguments(parser)
    return info_command.run(parser.parse_args([str(word) for word in words]))


def test_recording(labelled_recording, tmp_path, capsys):
    assert info(labelled_recording, '--json', tmp_path / 'info.json') == 0
    printed = capsys.readouterr().out
    assert 'frames     10, labelled 10' in printed
    assert '/ground_truth/skeletons       10  sensor_msgs/msg/PointCloud2' in printed
    assert 'start      2023-11-14T22:13:20' in printed
    assert "images     64x48, '16UC1', frame 'camera_depth_optical'" in printed
    assert 'warning' not in printed
    report = json.loads((tmp_path / 'info.json').read_text())
    assert (report['kind'], report['messages'], report['frames']) == ('recording', 40, 10)
    assert report['duration_s'] == pytest.approx(0.3, abs=0.001)
    assert report['size_bytes'] == labelled_recording.stat().st_size
    assert report['frame_topics']['ground_truth'] == '/ground_truth/skeletons'
    assert report['images'] == ["64x48, '16UC1', frame 'camera_depth_optical'"]
    assert report['warnings'] == []
    assert report['topics'][0] == {
        'name': '/depth/camera_info',
        'type_name': 'sensor_msgs/msg/CameraInfo',
        'messages': 10,
    }


def test_only_frames_with_a_known_joint_are_labelled(labelled_recording, tmp_path, capsys):
    frames = list(open_recording(labelled_recording))
    with RecordingWriter(tmp_path / 'some.mcap') as writer:
        for number, frame in enumerate(frames):
            truth = frame.ground_truth
            if number % 5 == 1:
                truth = no_skeletons(truth.joints)
            elif number % 5 > 1:
                truth = truth._replace(positions=np.full_like(truth.positions, np.nan))
            writer.write_frame(frame._replace(ground_truth=truth))
    assert info(tmp_path / 'some.mcap', '--json', tmp_path / 'info.json') == 0
    assert 'frames     10, labelled 2' in capsys.readouterr().out
    report = json.loads((tmp_path / 'info.json').read_text())
    assert report['labelled_frames'] == 2


def test_recording_without_frames_is_described(tmp_path, capsys):
    with RecordingWriter(tmp_path / 'one.mcap') as writer:
        writer.write('/chatter', 'std_msgs/msg/String', 5, b'\0\1\0\0\1\0\0\0\0')
    assert info(tmp_path / 'one.mcap') == 0
    printed = capsys.readouterr().out
    assert 'messages   1' in printed
    assert 'frames     0' in printed
    assert 'warning: it has no frames' in printed


def test_frames_that_cannot_be_used_are_a_warning(tmp_path, simple_frames, capsys):
    with RecordingWriter(tmp_path / 'one.mcap') as writer:
        for frame in simple_frames:
            writer.write_frame(frame._replace(labels=frame.labels[:20]))
    assert info(tmp_path / 'one.mcap') == 0
    printed = capsys.readouterr().out
    assert 'messages   40' in printed
    assert 'warning: the reading of frames stopped' in printed


def test_empty_recording(tmp_path, capsys):
    with RecordingWriter(tmp_path / 'empty'):
        pass
    assert info(tmp_path / 'empty') == 0
    assert 'messages   0' in capsys.readouterr().out


def test_truncated_recording_says_how_much_was_read(labelled_recording, tmp_path, capsys):
    path = tmp_path / 'cut.mcap'
    data = labelled_recording.read_bytes()
    path.write_bytes(data[: data.rindex(b'\x0f') - 200])
    assert info(path) == 0
    assert 'warning: cut.mcap: ' in capsys.readouterr().out


def test_what_is_neither_recording_nor_model(tmp_path):
    (tmp_path / 'text').write_text('hello')
    with pytest.raises(InputError, match='neither MCAP nor SQLite'):
        info(tmp_path / 'text')
    with pytest.raises(InputError, match='no such file'):
        info(tmp_path / 'gone')
    (tmp_path / 'model.npz').write_text('hello')
    with pytest.raises(InputError, match=r'model\.npz'):
        info(tmp_path / 'model.npz')


def test_json_that_cannot_be_written(labelled_recording, tmp_path):
    with pytest.raises(InputError, match=r'gone/info\.json'):
        info(labelled_recording, '--json', tmp_path / 'gone' / 'info.json')


def test_killed_recording(shared, capsys):
    assert info(shared / 'bags' / 'd160_killed') == 0
    printed = capsys.readouterr().out
    assert 'frames     152, labelled 0' in printed
    assert 'read up to there: 638 messages, 8.9 MB, 9.8 s' in printed


def test_model_of_the_package_by_its_name(
    small_model_file, shipped, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match='front'):
        info('front')
    (shipped / 'front.npz').write_bytes(small_model_file.read_bytes())
    assert info('front') == 0
    printed = capsys.readouterr().out
    assert re.search(rf'^model +{shipped / "front.npz"}$', printed, re.MULTILINE)
    size = small_model_file.stat().st_size
    assert re.search(rf'^size +{size * 1e-6:.1f} MB$', printed, re.MULTILINE)
