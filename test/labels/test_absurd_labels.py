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

"""Files of labels with absurd, missing or repeated entries are refused in one sentence."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[1] / 'bags'))

from label_recordings import (
    CAMERA_FRAME,
    FRAME_TIME,
    START,
    markers,
    pose,
    seconds,
    sphere,
    stamps,
    write_recording,
)

from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.limits import FARTHEST, LATEST, regular_stamps
from lsc_pose_ros.labels.sources.bvh_file import bvh_tracks
from lsc_pose_ros.labels.sources.c3d_file import c3d_tracks
from lsc_pose_ros.labels.sources.keypoint_files import load_keypoints
from lsc_pose_ros.labels.sources.recorded_topics import marker_samples
from lsc_pose_ros.labels.sources.table_file import csv_samples
from lsc_pose_ros.labels.tracks import body_tracks, skeletons_of
from lsc_pose_ros.labels.vocabulary import load_vocabulary

OURS = load_vocabulary('lsc_pose')
COCO = load_vocabulary('coco')

LONG = '9' * 5000


def tracks_of(path, text, scale=1.0):
    path.write_text(text)
    return body_tracks(csv_samples(path, OURS, '', scale, START), OURS)


@pytest.mark.parametrize(
    ('row', 'reason'),
    [
        ('1e999999,1,head,0,0,2', "'1e999999' in the column stamp is not a number"),
        ('1e99999999999,1,head,0,0,2', 'in the column stamp is not a number'),
        (f'{LONG},1,head,0,0,2', 'in the column stamp is not a number'),
        ('1e20,1,head,0,0,2', '1e20 in the column stamp is no time'),
        ('3e9,1,head,0,0,2', '3e9 in the column stamp is no time'),
        ('-1,1,head,0,0,2', '-1 in the column stamp is no time'),
        ('1_0,1,head,0,0,2', 'not a number'),
        ('nan,1,head,0,0,2', 'not a number'),
        ('0' * 5000 + '3e9,1,head,0,0,2', 'in the column stamp is not a number'),
        ('1,1e400,head,0,0,2', "'1e400' in the column body is not a number"),
        ('1,65536,head,0,0,2', 'the body 65536 is not a number from 0'),
        ('1,nan,head,0,0,2', 'the body nan is not a number from 0'),
        (f'1,1,{LONG},0,0,2', 'has no joint'),
        ('1,1,٣,0,0,2', 'has no joint'),
        ('1,1,head,1e400,0,2', "'1e400' in the column x is not a number"),
        ('1,1,head,0,-inf,2', "'-inf' in the column y is not a number"),
        (f'1,1,head,0,0,{LONG}', 'in the column z is not a number'),
        ('1,1,head,0,0,1e12', 'the joint is at .0, 0, 1e.12. m; give the metres per unit'),
        ('1,1,head,0,0', 'fewer fields than the first line'),
        ('1,1,head,0,0,2,3', 'more fields than the first line'),
    ],
)
def test_row_of_a_table_is_refused(row, reason, tmp_path):
    text = f'stamp,body,joint,x,y,z\n0,1,neck,0,0,2\n{row}\n'
    with pytest.raises(InputError, match=f'joints.csv, line 3: .*{reason}') as caught:
        tracks_of(tmp_path / 'joints.csv', text)
    assert len(str(caught.value)) < 700


def test_time_in_a_table_that_ends_the_clock_is_refused(tmp_path):
    text = 'time,joint,x,y,z\n1e9,head,0,0,2\n'
    with pytest.raises(InputError, match='line 2: 1e9 in the column time is no time'):
        tracks_of(tmp_path / 'joints.csv', text)


@pytest.mark.parametrize('frame', ['-1', '1.5', '1e99999999999', '1e15', 'nan', LONG])
def test_frame_in_a_table_that_is_no_number_of_an_image(frame, tmp_path):
    path = tmp_path / 'pixels.csv'
    path.write_text(f'frame,joint,u,v\n{frame},nose,1,1\n')
    with pytest.raises(InputError, match=r'pixels\.csv, line 2: .* in the column frame'):
        load_keypoints(path, COCO, START, 0.0)


def test_table_without_line_ends_is_refused_before_it_fills_the_memory(tmp_path):
    path = tmp_path / 'joints.csv'
    with path.open('wb') as stream:
        stream.truncate(1 << 40)  # of zeros, which take no place on the disk
    with pytest.raises(InputError, match='line 1: it has more than 131072 characters'):
        next(csv_samples(path, OURS, '', 1.0, START))


def test_joint_that_is_given_twice_is_refused(tmp_path):
    path = tmp_path / 'joints.csv'
    rows = ['1,1,head,0,0,2', '1,2,head,0,0,2', '2,1,head,0,0,2', '1,1,neck,0,0,2']
    begin = 'stamp,body,joint,x,y,z\n'
    assert len(tracks_of(path, begin + '\n'.join(rows))) == 2
    for again in ('1,1,head,0,0,2', '1.0,1,head,5,5,5', '1,1,0,nan,nan,nan'):
        with pytest.raises(InputError, match='line 6: the joint head of body 1 was given before'):
            tracks_of(path, begin + '\n'.join([*rows, again]))


def test_keypoint_that_is_given_twice_is_refused(tmp_path):
    path = tmp_path / 'pixels.csv'
    path.write_text('frame,joint,u,v\n3,nose,1,1\n4,nose,1,1\n3,nose,1,1\n')
    with pytest.raises(InputError, match='line 4: the joint nose of body 1 was given before'):
        load_keypoints(path, COCO, START, 0.0)


@pytest.mark.parametrize('name', ['x', 'joint', 'stamp', 'body'])
def test_column_that_is_named_twice_is_refused(name, tmp_path):
    text = f'stamp,body,joint,x,y,z,{name}\n1,1,head,0,0,2,3\n'
    with pytest.raises(InputError, match=f'names the column {name} twice'):
        tracks_of(tmp_path / 'joints.csv', text)


def test_other_columns_may_have_the_same_name(tmp_path):
    text = 'stamp,joint,x,y,z,note,note\n1,head,0,0,2,a,b\n'
    assert len(tracks_of(tmp_path / 'joints.csv', text)) == 1


POINTS = [1.0, 2.0, 1.0] * 17


def people(path, entries):
    path.write_text(entries if isinstance(entries, str) else json.dumps(entries))
    return load_keypoints(path, COCO, START, 0.0)


@pytest.mark.parametrize('image', [True, -1, None, 1.5, '0', LATEST + 1, [], {}])
def test_image_id_that_is_none_is_refused(image, tmp_path):
    good = {'image_id': 0, 'keypoints': POINTS}
    with pytest.raises(InputError, match=r'people\.json, entry 1 \(from 0\) is no'):
        people(tmp_path / 'people.json', [good, {'image_id': image, 'keypoints': POINTS}])


@pytest.mark.parametrize('entry', ['null', '1', '[]', '"a"', '{}'])
def test_entry_that_is_no_person_is_refused(entry, tmp_path):
    with pytest.raises(InputError, match=r'people\.json, entry 0 \(from 0\) is no'):
        people(tmp_path / 'people.json', f'[{entry}]')


@pytest.mark.parametrize(
    'track',
    ['a', None, [], {}, True, 1.5, -1, 65536, 10**25, float('inf'), float('nan'), 'x' * 999],
)
def test_track_id_that_is_no_number_is_refused(track, tmp_path):
    entry = {'image_id': 0, 'keypoints': POINTS, 'track_id': track}
    with pytest.raises(InputError, match=r'entry 0 .*: the track_id .* is not a number') as caught:
        people(tmp_path / 'people.json', [entry])
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize('value', ['a', [1], {}, True, 1e400, -1e300, 10**25])
def test_coordinate_that_is_no_number_is_refused(value, tmp_path):
    entry = {'image_id': 0, 'keypoints': [value, *POINTS[1:]]}
    with pytest.raises(InputError, match=r'entry 0 .* is no coordinate of a pixel'):
        people(tmp_path / 'people.json', [entry])


@pytest.mark.parametrize(('value', 'sure'), [(None, 1), (float('nan'), 1), (5, None), (5, 0)])
def test_unknown_keypoints_are_left_out(value, sure, tmp_path):
    entry = {'image_id': 0, 'keypoints': [value, 2, sure, *POINTS[3:]]}
    (person,) = people(tmp_path / 'people.json', [entry])['frame', 0]
    assert np.isnan(person.pixels[0]).any()
    assert (person.pixels[1:] == (1, 2)).all()


@pytest.mark.parametrize('text', ['[' * 200_000, f'[{{"image_id": {LONG}}}]', '{"a": 1}', '[', ''])
def test_json_that_is_no_list_of_people_is_refused(text, tmp_path):
    with pytest.raises(InputError, match=r'people\.json'):
        people(tmp_path / 'people.json', text)


def test_body_that_is_in_an_image_twice_is_refused(tmp_path):
    path = tmp_path / 'people.json'
    first, second = ({'image_id': 3, 'keypoints': POINTS, 'track_id': 1} for _ in range(2))
    assert len(people(path, [first, {**second, 'track_id': 2}])['frame', 3]) == 2
    assert len(people(path, [first, {**second, 'image_id': 4}])) == 2
    with pytest.raises(InputError, match=r'entry 1 .*: body 1 is in image 3 twice'):
        people(path, [first, second])
    del first['track_id']
    with pytest.raises(InputError, match=r'entry 1 .*: body 1 is in image 3 twice'):
        people(path, [first, second])


@pytest.mark.parametrize(
    'contents', [[], {'people': None}, {'people': [1]}, {'people': [None]}, {'people': {}}]
)
def test_openpose_without_people_is_refused(contents, tmp_path):
    (tmp_path / 'a_0_keypoints.json').write_text(json.dumps(contents))
    with pytest.raises(InputError, match=r'a_0_keypoints\.json has no list people'):
        load_keypoints(tmp_path, COCO, START, 0.0)


def test_openpose_with_two_files_for_an_image_is_refused(tmp_path):
    for name in ('a_07_keypoints.json', 'b_7_keypoints.json'):
        (tmp_path / name).write_text('{"people": []}')
    with pytest.raises(InputError, match='is the second file for depth image 7'):
        load_keypoints(tmp_path, COCO, START, 0.0)


BVH = """HIERARCHY
ROOT head
{{
  OFFSET 0 {offset} 0
  CHANNELS {channels}
}}
MOTION
Frames: {frames}
Frame Time: {time}
"""


@pytest.mark.parametrize(
    ('offset', 'time', 'scale', 'reason'),
    [
        ('1e400', '0.1', 1.0, 'line 4: a number is not finite'),
        ('1e300', '0.1', 1.0, 'line 4: a number is not finite, or beyond 1e.09'),
        ('1', '1e300', 1.0, 'line 9: a number is not finite'),
        ('1', '1e9', 1.0, '2 samples with 1e.09 s from each to the next end after 2038'),
        ('1e9', '0.1', 1000.0, 'a joint is at 1e.12 m; give the metres per unit with --scale'),
        (LONG, '0.1', 1.0, 'line 4: a number is not finite'),
    ],
)
def test_bvh_with_absurd_numbers_is_refused(offset, time, scale, reason, tmp_path):
    path = tmp_path / 'motion.bvh'
    head = BVH.format(offset=offset, time=time, channels='1 Xrotation', frames=2)
    path.write_text(f'{head}0\n0\n')
    with pytest.raises(InputError, match=rf'motion\.bvh.*{reason}'):
        bvh_tracks([path], OURS, '', scale, START)


def test_bvh_with_more_poses_than_memory_is_refused(tmp_path):
    """A joint without channels takes no bytes in the frames, but memory for its poses."""
    path = tmp_path / 'motion.bvh'
    joint = '\n'.join(
        f'JOINT j{number}\n{{\nOFFSET 0 0 0\nCHANNELS 0\n}}' for number in range(999)
    )
    head = BVH.format(offset=0, time=0.01, channels=f'1 Xrotation\n{joint}', frames=20_001)
    path.write_text(head + '0\n' * 20_001)
    with pytest.raises(InputError, match='20001 frames of 1000 joints are too many'):
        bvh_tracks([path], OURS, '', 1.0, START)
    path.write_text(
        head.replace('JOINT j7\n', 'JOINT j7\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\nJOINT k\n')
    )
    with pytest.raises(InputError, match='more than 1000 joints'):
        bvh_tracks([path], OURS, '', 1.0, START)


@pytest.mark.parametrize('scale', [None, 1e9])
def test_c3d_with_absurd_positions_is_refused(scale, tmp_path):
    c3d = pytest.importorskip('c3d')
    path = tmp_path / 'trial.c3d'
    writer = c3d.Writer(point_rate=20.0, point_units='mm ')
    writer.set_point_labels(['LFHD', 'RFHD'])
    points = np.full((2, 5), 1e30 if scale is None else 10.0, np.float32)
    points[:, 3:] = 0
    writer.add_frames([(points, np.array([[]]))] * 3)
    with path.open('wb') as stream:
        writer.write(stream)
    with pytest.raises(InputError, match=r'trial\.c3d: a joint is at 1e.* m; give the metres'):
        c3d_tracks(path, load_vocabulary('plug_in_gait'), '', scale, START)


def test_c3d_with_a_point_twice_is_refused(tmp_path):
    c3d = pytest.importorskip('c3d')
    path = tmp_path / 'trial.c3d'
    writer = c3d.Writer(point_rate=20.0, point_units='mm ')
    writer.set_point_labels(['LFHD', 'RFHD', 'LFHD'])
    writer.add_frames([(np.zeros((3, 5), np.float32), np.array([[]]))] * 3)
    with path.open('wb') as stream:
        writer.write(stream)
    with pytest.raises(InputError, match=r'trial\.c3d has the point LFHD twice'):
        c3d_tracks(path, load_vocabulary('plug_in_gait'), '', None, START)


def test_c3d_that_is_none_is_refused(tmp_path):
    pytest.importorskip('c3d')
    path = tmp_path / 'trial.c3d'
    for data in (b'', b'\2P', b'\2P' + bytes(600), bytes(range(256)) * 8):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r'trial\.c3d') as caught:
            c3d_tracks(path, load_vocabulary('plug_in_gait'), '', None, START)
        assert len(str(caught.value)) < 500


def test_marker_with_the_number_of_no_body_is_refused(tmp_path):
    message = markers(START, [sphere(START, 3_200_000 * 32, (0, 0, 2))])
    recording = RecordingReader(write_recording(tmp_path / 'k.mcap', [message]))
    azure = load_vocabulary('azure')._replace(joints_per_body=32)
    with pytest.raises(InputError, match='a marker of /body_tracking_data has the number'):
        list(marker_samples(recording, '', azure))


def test_absurd_positions_of_topics_are_unknown(tmp_path):
    names = load_vocabulary('azure').names
    spheres = [
        sphere(START, number, (1e300 if number % 2 else 0, 0, 2)) for number in range(len(names))
    ]
    recording = RecordingReader(write_recording(tmp_path / 'k.mcap', [markers(START, spheres)]))
    azure = load_vocabulary('azure')._replace(joints_per_body=100)
    (track,) = body_tracks(marker_samples(recording, '', azure), azure)
    known = np.isfinite(track.positions)
    assert known.any()
    assert (np.abs(track.positions[known]) <= FARTHEST).all()
    assert not known.all()


@pytest.mark.filterwarnings('error')
def test_absurd_positions_of_a_body_are_unknown():
    joints = pose(0.0)
    joints[3], joints[4, 1], joints[5, 2] = 1e300, -np.inf, np.nan
    skeletons = skeletons_of({7: joints, 3: np.full((20, 3), 1e300), 9: np.full((20, 3), np.nan)})
    assert skeletons.bodies.tolist() == [7]
    unknown = np.isnan(skeletons.positions[0]).all(axis=1)
    assert np.flatnonzero(unknown).tolist() == [3, 4, 5]


@pytest.mark.parametrize('period', [-1.0, 1e300, np.nan, np.inf])
def test_stamps_that_end_the_clock_are_refused(period):
    with pytest.raises(InputError, match='motion'):
        regular_stamps(Path('motion'), START, 3, period)
    assert regular_stamps(Path('motion'), START, 3, 0.1).tolist() == [
        START, START + 100_000_000, START + 200_000_000
    ]  # fmt: skip


@pytest.mark.parametrize(
    ('option', 'value'),
    [
        (option, value)
        for option in ('--time-offset', '--max-gap', '--scale', '--min-confidence',
                       '--before-limit', '--deep-limit', '--length-limit', '--mask-margin')
        for value in ('nan', 'inf', '1e300', 'x')
        if (option, value) != ('--min-confidence', '1e300')
    ] + [('--max-gap', '-1'), ('--scale', '0'), ('--scale', '-1')],
)  # fmt: skip
def test_absurd_options_of_label_are_refused(option, value, tmp_path, capsys):
    words = ['k.mcap', '-o', str(tmp_path / 'o.mcap'), '--from', 'csv', '--source', 'k.csv']
    with pytest.raises(SystemExit):
        main(['label', *words, f'{option}={value}'])
    said = capsys.readouterr().err
    assert option in said
    assert 'not a' in said


@pytest.mark.parametrize('option', ['--scale', '--fps'])
@pytest.mark.parametrize('value', ['nan', 'inf', '1e300', '1e-300', '0', '-1'])
def test_absurd_options_of_import_are_refused(option, value, tmp_path, capsys):
    with pytest.raises(SystemExit):
        main(['import', 'images', str(tmp_path), 'o.mcap', f'{option}={value}'])
    assert option in capsys.readouterr().err


def csv_of(path, moments, z='2'):
    rows = ['stamp,joint,x,y,z']
    for moment in moments:
        joints = pose(seconds(moment))
        rows += [
            f'{moment},{name},{joints[number, 0]},{joints[number, 1]},{z}'
            for number, name in enumerate(JOINT_NAMES)
        ]
    path.write_text('\n'.join(rows))
    return path


def label(tmp_path, recording, table, *words):
    output = tmp_path / 'labelled.mcap'
    begin = ['label', str(recording), '-o', str(output), '--no-check', '--from', 'csv']
    return main([*begin, '--source', str(table), *words])


@pytest.mark.parametrize(
    ('numbers', 'told'),
    [
        ([2, 3, 4], '2 frames got no label: 2 before the first label'),
        ([0, 1], '3 frames got no label: 3 after the last label'),
        ([0, 1, 4], '2 frames got no label: 2 in a gap of more than 0.1 s between labels'),
        ([1, 3], '3 frames got no label: 1 before the first label, '),
    ],
)
def test_why_frames_have_no_label_is_told(numbers, told, tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = csv_of(tmp_path / 'joints.csv', [stamps()[number] for number in numbers])
    assert label(tmp_path, recording, table) == 0
    assert told in capsys.readouterr().out


def test_frames_whose_joints_are_dropped_are_told(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = csv_of(tmp_path / 'joints.csv', stamps()[:4])
    table.write_text(f'{table.read_text()}\n{stamps()[4]},pelvis,0,0.05,1.0\n')
    assert label(tmp_path, recording, table, '--drop', 'before') == 0
    assert '1 frame got no label: 1 whose joints were all dropped' in capsys.readouterr().out


def test_labels_without_positions_are_told(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = csv_of(tmp_path / 'joints.csv', stamps(), z='nan')
    assert label(tmp_path, recording, table) == 2
    said = capsys.readouterr().err
    assert 'none of the 5 frames got a label: 5 with labels that have no position' in said
    assert '--time-offset' not in said


def test_labels_of_another_time_are_told(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = csv_of(tmp_path / 'joints.csv', [stamp + 100 * FRAME_TIME for stamp in stamps()])
    assert label(tmp_path, recording, table) == 2
    said = capsys.readouterr().err
    assert 'none of the 5 frames got a label: 5 before the first label; shift the labels' in said
    assert '--time-offset' in said
    assert CAMERA_FRAME not in said


def test_joints_behind_the_camera_are_left_out_and_told(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = csv_of(tmp_path / 'joints.csv', stamps()[:4])
    rows = [f'{stamps()[4]},pelvis,0,0.05,2.0', f'{stamps()[4]},head,0,-0.6,-2.0']
    table.write_text('\n'.join([table.read_text(), *rows]))
    assert label(tmp_path, recording, table) == 0
    said = capsys.readouterr()
    assert '5 of them labelled' in said.out
    assert 'joints behind the camera were left out: 1; check the extrinsic' in said.err
    table = csv_of(tmp_path / 'joints.csv', stamps(), z='-2')
    assert label(tmp_path, recording, table) == 2
    said = capsys.readouterr().err
    assert 'none of the 5 frames got a label: 5 whose joints are behind the camera' in said
