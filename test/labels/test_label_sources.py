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

"""Recordings with joints in the messages and files of other programs become labelled ones."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[1] / 'bags'))

from label_recordings import (
    CAMERA,
    CAMERA_FRAME,
    FRAME_TIME,
    START,
    frame,
    markers,
    pose,
    seconds,
    sphere,
    stamps,
    tf,
    transform,
    vector,
    write_recording,
)

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingReader, RecordingWriter
from lsc_pose_ros.bags.serialization.serialize import skeletons_message
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.extrinsic import Extrinsic
from lsc_pose_ros.labels.sources.keypoints import DEPTH_BEHIND_SURFACE
from lsc_pose_ros.labels.transform_history import Pose, TransformHistory
from lsc_pose_ros.labels.vocabulary import load_vocabulary, vocabularies

MILLIMETRE = 1e-3

# The camera in the world: 1.2 m up, looking along x.
ROTATION = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
QUATERNION = (-0.5, 0.5, -0.5, 0.5)
TRANSLATION = (0.3, -0.2, 1.2)
WORLD = Pose(ROTATION, np.array(TRANSLATION))


def labels_of(path):
    return [frame.ground_truth for frame in open_recording(path)]


def label(tmp_path, recording, *options):
    output = tmp_path / 'labelled.mcap'
    words = [str(recording), '-o', str(output), '--no-check', *map(str, options)]
    assert main(['label', *words]) == 0
    return labels_of(output)


def assert_right(labels, names=JOINT_NAMES, tolerance=MILLIMETRE):
    numbers = [JOINT_NUMBERS[name] for name in names]
    assert len(labels) == len(stamps())
    for stamp, skeletons in zip(stamps(), labels, strict=True):
        assert skeletons.bodies.tolist() == [1]
        error = np.linalg.norm(skeletons.positions[0] - pose(seconds(stamp)), axis=-1)
        assert (error[numbers] < tolerance).all()
        others = np.setdiff1d(np.arange(len(JOINT_NAMES)), numbers)
        assert np.isnan(skeletons.positions[0, others]).all()
        assert (skeletons.confidence[0] == np.isfinite(error)).all()


@pytest.fixture
def extrinsic(tmp_path):
    path = tmp_path / 'camera.yaml'
    path.write_text(f'translation: {list(TRANSLATION)}\nrotation: {list(QUATERNION)}\n')
    return path


def world(moment):
    return WORLD.apply(pose(moment))


def sample_times():
    """Times of another program: 7 ms off those of the depth images, twice as often."""
    return [START - 43_000_000 + number * FRAME_TIME // 2 for number in range(13)]


def test_rotation_of_these_tests_is_the_quaternion():
    history = TransformHistory(0)
    Extrinsic('world', TRANSLATION, QUATERNION).add_to(history, 'camera')
    found = history.lookup('world', 'camera', 5)
    np.testing.assert_allclose(found.rotation, ROTATION, atol=1e-12)
    np.testing.assert_allclose(found.translation, TRANSLATION)


def test_tf_of_motion_capture_with_static_extrinsic(tmp_path):
    static = transform(START, 'world', CAMERA_FRAME, TRANSLATION, QUATERNION)
    messages = [tf(START, [static], '/tf_static')]
    for stamp in sample_times():
        joints = world(seconds(stamp))
        messages.append(
            tf(
                stamp,
                [
                    transform(stamp, 'world', f'alice/{name}', joints[number])
                    for number, name in enumerate(JOINT_NAMES)
                ],
            )
        )
    recording = write_recording(tmp_path / 'mocap.mcap', messages)
    mapping = tmp_path / 'frames.yaml'
    mapping.write_text("pattern: 'alice/{joint}'\nbodies: [7]\n")
    assert_right(label(tmp_path, recording, '--from', 'tf', '--frames', mapping))
    copied = RecordingReader(tmp_path / 'labelled.mcap').topics
    assert copied['/tf'].count == len(sample_times())
    assert copied['/tf_static'].count == 1


def test_tf_is_rotated_on_an_arc_between_two_samples(tmp_path):
    """A joint 0.4 m from the axis of a frame that turns by 90 degrees between two samples."""
    middle = np.array([0.0, 0.0, 2.0])
    half = np.sqrt(0.5)
    end = START + 2 * FRAME_TIME
    messages = [
        tf(START, [transform(START, CAMERA_FRAME, 'segment', middle)]),
        tf(end, [transform(end, CAMERA_FRAME, 'segment', middle, (0, 0, half, half))]),
    ]
    recording = write_recording(tmp_path / 'turn.mcap', messages)
    mapping = tmp_path / 'frames.yaml'
    mapping.write_text('bodies: {1: {l_hand: {frame: segment, offset: [0.4, 0, 0]}}}\n')
    options = ('--from', 'tf', '--frames', mapping, '--max-gap', 0.3)
    labels = label(tmp_path, recording, *options)
    hand = JOINT_NUMBERS['l_hand']
    expected = middle + 0.4 * np.array([half, half, 0])
    np.testing.assert_allclose(labels[1].positions[0, hand], expected, atol=1e-6)
    assert [len(each.bodies) for each in labels] == [1, 1, 1, 0, 0]
    assert [len(each.bodies) for each in label(tmp_path, recording, *options[:4])] == [
        1,
        0,
        1,
        0,
        0,
    ]


def test_markers_of_the_azure_kinect(tmp_path):
    azure = load_vocabulary('azure')
    messages = []
    for stamp in stamps():
        joints = pose(seconds(stamp))
        spheres = [
            sphere(stamp, 300 + azure.names.index(next(iter(source.weights))), joints[number])
            for name, source in azure.joints.items()
            for number in [JOINT_NUMBERS[name]]
        ]
        spheres += [sphere(stamp, 399, (0, 0, 0)), sphere(stamp, 326, (9, 9, 9), action=2)]
        messages.append(markers(stamp, spheres))
    recording = write_recording(tmp_path / 'azure.mcap', messages)
    assert_right(label(tmp_path, recording, '--from', 'markers'))


def test_markers_that_are_named_by_their_namespace(tmp_path):
    messages = [
        markers(stamp, [sphere(stamp, 1, pose(seconds(stamp))[0], namespace='SKULL')])
        for stamp in stamps()
    ]
    recording = write_recording(tmp_path / 'named.mcap', messages)
    vocabulary = tmp_path / 'mine.yaml'
    vocabulary.write_text('joints: {head: SKULL}\n')
    labels = label(tmp_path, recording, '--from', 'markers', '--joints', vocabulary)
    assert_right(labels, ['head'])


def test_markers_of_this_node_point_to_its_skeletons(tmp_path, capsys):
    messages = []
    for stamp in stamps():
        shape = sphere(stamp, 1, (0, 0, 0), namespace='joints')
        shape.type = 7  # SPHERE_LIST
        shape.points = [vector('Point', joint) for joint in pose(seconds(stamp))]
        messages.append(markers(stamp, [shape], '/pose_node/joint_markers'))
    recording = write_recording(tmp_path / 'own.mcap', messages)
    said = fails(capsys, recording, '-o', tmp_path / 'labelled.mcap', '--from', 'markers')
    assert 'the markers of /pose_node/joint_markers are lists of points' in said
    assert '--from skeletons' in said


def test_tf_of_an_absent_body_is_one_warning(tmp_path, capsys):
    messages = []
    for stamp in stamps():
        known = [
            transform(stamp, CAMERA_FRAME, f'{name}_1', joint)
            for name, joint in zip(JOINT_NAMES, pose(seconds(stamp)), strict=True)
            if name != 'l_hand' or stamp != START
        ]
        messages.append(tf(stamp, known))
    recording = write_recording(tmp_path / 'alone.mcap', messages)
    mapping = tmp_path / 'frames.yaml'
    mapping.write_text("pattern: '{joint}_{body}'\nbodies: [1, 2]\n")
    label(tmp_path, recording, '--from', 'tf', '--frames', mapping)
    first, second = sorted(capsys.readouterr().err.splitlines())
    assert 'body 1: the TF frame l_hand_1 is not known at the time of 1 depth images' in first
    assert 'body 2: 20 TF frames (head_2, neck_2, torso_2, ...) are not known' in second
    assert 'at the time of 5 depth images' in second


def test_skeletons_of_another_camera(tmp_path, extrinsic):
    """Estimates of a camera at the origin of the world teach this camera."""
    messages = []
    for stamp in sample_times():
        joints = world(seconds(stamp)).astype(np.float32)[None]
        confidence = np.full((1, len(JOINT_NAMES)), 0.9, np.float32)
        confidence[0, 3] = 0.2
        numbers = np.arange(len(JOINT_NAMES), dtype=np.uint16)
        cloud = Skeletons(np.array([9], np.uint16), numbers, joints, confidence)
        data = skeletons_message(stamp, 'world', cloud)
        messages.append(('/other/skeletons', 'sensor_msgs/msg/PointCloud2', stamp, data))
    recording = write_recording(tmp_path / 'two.mcap', messages)
    labels = label(
        tmp_path, recording, '--from', 'skeletons', '--extrinsic', extrinsic,
        '--min-confidence', 0.5,
    )  # fmt: skip
    assert_right(labels, [name for name in JOINT_NAMES if name != 'pelvis'])


def csv_rows(joints_of, *, column='stamp', times=None):
    rows = [f'{column},body,joint,x,y,z']
    for stamp in times or sample_times():
        whole, rest = divmod(stamp, 10**9)
        moment = f'{whole}.{rest:09d}' if column == 'stamp' else f'{seconds(stamp):.9f}'
        for name, joint in zip(JOINT_NAMES, joints_of(seconds(stamp)), strict=True):
            rows.append(f'{moment},4,{name},' + ','.join(f'{each:.9f}' for each in joint))
    return '\n'.join(rows) + '\n'


def test_csv_in_the_frame_of_the_camera(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap', body=1)
    table = tmp_path / 'joints.csv'
    table.write_text(csv_rows(pose))
    assert_right(label(tmp_path, recording, '--from', 'csv', '--source', table))


def test_csv_in_millimetres_of_the_world_with_times_from_the_first_image(tmp_path, extrinsic):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'joints.csv'
    late = 0.25
    table.write_text(csv_rows(lambda moment: 1000 * world(moment - late), column='time', times=[
        START + round((late - 0.1 + 0.05 * number) * 1e9) for number in range(15)
    ]))  # fmt: skip
    labels = label(
        tmp_path, recording, '--from', 'csv', '--source', table, '--extrinsic', extrinsic,
        '--scale', 0.001, '--time-offset', -late,
    )  # fmt: skip
    assert_right(labels)


def test_gaps_are_left_out_and_nothing_is_extrapolated(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'joints.csv'
    times = [START + FRAME_TIME, START + 3 * FRAME_TIME]
    table.write_text(csv_rows(pose, times=times))
    labels = label(tmp_path, recording, '--from', 'csv', '--source', table)
    assert [len(each.bodies) for each in labels] == [0, 1, 0, 1, 0]


@pytest.mark.parametrize(('place', 'shift'), [(-1, -40_000), (0, 40_000)])
def test_the_first_and_the_last_image_of_a_file_may_be_rounded_off(tmp_path, place, shift):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'joints.csv'
    times = stamps()
    times[place] += shift
    table.write_text(csv_rows(pose, column='time', times=times))
    assert_right(label(tmp_path, recording, '--from', 'csv', '--source', table))


def test_images_before_and_after_a_gap_may_be_rounded_off(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'joints.csv'
    times = [START, START + FRAME_TIME - 1000, START + 3 * FRAME_TIME + 1000, stamps()[4]]
    table.write_text(csv_rows(pose, times=times))
    labels = label(tmp_path, recording, '--from', 'csv', '--source', table)
    assert [len(each.bodies) for each in labels] == [1, 1, 0, 1, 1]


BVH = """HIERARCHY
ROOT pelvis
{{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT head
  {{
    OFFSET 0 70 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {{
      OFFSET 0 10 0
    }}
  }}
}}
MOTION
Frames: {count}
Frame Time: 0.05
{rows}
"""


def test_bvh_with_the_pose_of_the_camera(tmp_path):
    """The body of the file leans by 90 degrees about z: its head is 70 cm beside the pelvis."""
    recording = write_recording(tmp_path / 'depth.mcap')
    source = tmp_path / 'motion.bvh'
    rows = [f'{number} 100 -200 90 0 0 0 0 0' for number in range(9)]
    source.write_text(BVH.format(count=len(rows), rows='\n'.join(rows)))
    camera = tmp_path / 'camera.yaml'
    # The axes of the file: x right, y up, z towards the camera, which is 1 m above its ground.
    camera.write_text('translation: [0, 1, 0]\nrotation: [1, 0, 0, 0]\n')
    labels = label(
        tmp_path, recording, '--from', 'bvh', '--source', source, '--extrinsic', camera,
        '--scale', 0.01,
    )  # fmt: skip
    for number, skeletons in enumerate(labels):
        pelvis, head = (skeletons.positions[0, JOINT_NUMBERS[name]] for name in ('pelvis', 'head'))
        np.testing.assert_allclose(pelvis, [0.02 * number, 0, 2], atol=1e-5)
        np.testing.assert_allclose(head, [0.02 * number - 0.7, 0, 2], atol=1e-5)


def test_c3d_with_hidden_markers(tmp_path, extrinsic):
    c3d = pytest.importorskip('c3d')
    vocabulary = tmp_path / 'centres.yaml'
    vocabulary.write_text('joints: {head: HEAD, l_hand: [LFIN, LTHU]}\n')
    writer = c3d.Writer(point_rate=20.0, point_units='mm ')
    writer.set_point_labels(['Bob:HEAD', 'Bob:LFIN', 'Bob:LTHU'])
    head, hand = JOINT_NUMBERS['head'], JOINT_NUMBERS['l_hand']
    frames = []
    for number in range(9):
        joints = 1000 * world(0.05 * number)
        points = np.zeros((3, 5), np.float32)
        points[:, :3] = joints[head], joints[hand] + 50, joints[hand] - 50
        points[0, 3] = -1 if number == 4 else 0
        frames.append((points, np.array([[]])))
    writer.add_frames(frames)
    source = tmp_path / 'trial.c3d'
    with source.open('wb') as stream:
        writer.write(stream)
    recording = write_recording(tmp_path / 'depth.mcap')
    labels = label(
        tmp_path, recording, '--from', 'c3d', '--source', source, '--extrinsic', extrinsic,
        '--joints', vocabulary,
    )  # fmt: skip
    known = [np.isfinite(each.positions[0, head]).all() for each in labels]
    assert known == [True, True, False, True, True]
    for stamp, skeletons in zip(stamps(), labels, strict=True):
        true = pose(seconds(stamp))
        assert np.abs(skeletons.positions[0, hand] - true[hand]).max() < MILLIMETRE
        if np.isfinite(skeletons.positions[0, head]).all():
            assert np.abs(skeletons.positions[0, head] - true[head]).max() < MILLIMETRE


def pixels_of(moment):
    return project(pose(moment), CAMERA)


def assert_behind_the_surface(labels, names):
    """The pixel is right, and the joint lies behind the surface at 1.9 m as documented."""
    for stamp, skeletons in zip(stamps(), labels, strict=True):
        pixels = project(skeletons.positions[0], CAMERA)
        true = pixels_of(seconds(stamp))
        for name in names:
            number = JOINT_NUMBERS[name]
            assert np.abs(pixels[number] - true[number]).max() < 1e-2
            behind = DEPTH_BEHIND_SURFACE[name.removeprefix('l_').removeprefix('r_')]
            assert abs(skeletons.positions[0, number, 2] - 1.9 - behind) < MILLIMETRE


def test_keypoints_of_a_csv_file(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'pixels.csv'
    rows = ['frame, body, joint, u, v, confidence']
    for number, stamp in enumerate(stamps()):
        pixels = pixels_of(seconds(stamp))
        for name in ('l_shoulder', 'r_hip'):
            u, v = pixels[JOINT_NUMBERS[name]]
            rows.append(f'{number}, 1, {name}, {u:.4f}, {v:.4f}, 0.9')
        rows.append(f'{number}, 1, head, 3, 3, 0.1')
    table.write_text('\n'.join(rows))
    labels = label(
        tmp_path, recording, '--from', 'keypoints', '--source', table, '--joints', 'lsc_pose',
        '--min-confidence', 0.5,
    )  # fmt: skip
    assert_behind_the_surface(labels, ['l_shoulder', 'r_hip'])
    assert all(np.isnan(each.positions[0, JOINT_NUMBERS['head']]).all() for each in labels)


def keypoint_rows(moments, column='stamp'):
    """A CSV file of one keypoint in each image, with texts of its moments."""
    rows = [f'{column},joint,u,v']
    for stamp, moment in zip(stamps(), moments, strict=True):
        u, v = pixels_of(seconds(stamp))[JOINT_NUMBERS['head']]
        rows.append(f'{moment},head,{u:.4f},{v:.4f}')
    return '\n'.join(rows)


@pytest.mark.parametrize(
    ('column', 'text'),
    [
        ('stamp', lambda stamp: repr(stamp * 1e-9)),
        ('stamp', lambda stamp: str(stamp + 4_900_000)),
        ('stamp', lambda stamp: str(stamp - 4_900_000)),
        ('time', lambda stamp: f'{seconds(stamp) + 4e-4:.4f}'),
    ],
)
def test_keypoints_belong_to_the_nearest_depth_image(tmp_path, column, text):
    # Stamps that no float has exactly.
    shift = 33_333_333
    recording = tmp_path / 'depth.mcap'
    with RecordingWriter(recording) as writer:
        for stamp in stamps():
            writer.write_frame(frame(stamp + shift))
    table = tmp_path / 'pixels.csv'
    first = 0 if column == 'time' else shift
    table.write_text(keypoint_rows([text(stamp + first) for stamp in stamps()], column))
    options = ('--from', 'keypoints', '--source', table, '--joints', 'lsc_pose')
    assert_behind_the_surface(label(tmp_path, recording, *options), ['head'])


def test_keypoints_of_other_times_are_told_with_their_distance(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'pixels.csv'
    table.write_text(keypoint_rows([stamp + 6_000_000 for stamp in stamps()]))
    options = ('--from', 'keypoints', '--source', table, '--joints', 'lsc_pose')
    said = fails(capsys, recording, '-o', tmp_path / 'labelled.mcap', *options)
    assert '5 images with keypoints have no depth image within 5 ms of their stamp' in said
    assert 'the closest is 6.0 ms away' in said
    assert '--time-offset' in said
    assert 'the column frame' in said
    labels = label(tmp_path, recording, *options, '--time-offset', -0.004)
    assert_behind_the_surface(labels, ['head'])
    table.write_text(keypoint_rows(range(3, 8), 'frame'))
    label(tmp_path, recording, *options)
    said = capsys.readouterr().err
    assert '3 images with keypoints have the number of no depth image; the 5 depth' in said


def body_25(moment):
    """The triples of OpenPose for our pose, with a joint that it has not found."""
    vocabulary = load_vocabulary('openpose25')
    values = np.zeros((25, 3))
    for name, source in vocabulary.joints.items():
        if len(source.weights) == 1:
            index = vocabulary.number_of(next(iter(source.weights)))
            values[index] = *pixels_of(moment)[JOINT_NUMBERS[name]], 0.8
    values[vocabulary.number_of('LKnee')] = 0
    return values.reshape(-1).tolist()


def test_keypoints_of_openpose(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap')
    folder = tmp_path / 'openpose'
    folder.mkdir()
    for number, stamp in enumerate(stamps()):
        people = [{'person_id': [-1], 'pose_keypoints_2d': body_25(seconds(stamp))}]
        path = folder / f'video_{number:012d}_keypoints.json'
        path.write_text(json.dumps({'version': 1.3, 'people': people}))
    labels = label(
        tmp_path, recording, '--from', 'keypoints', '--source', folder, '--joints', 'openpose25'
    )
    assert_behind_the_surface(labels, ['neck', 'r_knee', 'l_elbow', 'pelvis'])
    assert np.isnan(labels[0].positions[0, JOINT_NUMBERS['l_knee']]).all()


def test_keypoints_in_the_results_of_coco(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap')
    vocabulary = load_vocabulary('coco')
    people = []
    for number, stamp in enumerate(stamps()):
        values = np.zeros((17, 3))
        for name, source in vocabulary.joints.items():
            if len(source.weights) == 1:
                index = vocabulary.number_of(next(iter(source.weights)))
                values[index] = *pixels_of(seconds(stamp))[JOINT_NUMBERS[name]], 2
        keypoints = values.reshape(-1).tolist()
        people.append({'image_id': number, 'category_id': 1, 'keypoints': keypoints, 'score': 1})
    path = tmp_path / 'results.json'
    path.write_text(json.dumps(people))
    labels = label(tmp_path, recording, '--from', 'keypoints', '--source', path)
    assert_behind_the_surface(labels, ['l_wrist', 'r_ankle', 'r_shoulder'])


def test_bodies_get_the_numbers_of_the_mask(tmp_path):
    recording = write_recording(tmp_path / 'depth.mcap', body=6)
    table = tmp_path / 'joints.csv'
    table.write_text(csv_rows(pose))
    labels = label(tmp_path, recording, '--from', 'csv', '--source', table)
    assert [each.bodies.tolist() for each in labels] == [[6]] * len(labels)


def fails(capsys, *words):
    assert main(['label', *map(str, words)]) == 2
    return capsys.readouterr().err


def test_unusable_sources_are_told_and_nothing_is_written(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    output = tmp_path / 'labelled.mcap'
    begin = (recording, '-o', output, '--from')
    table = tmp_path / 'joints.csv'
    table.write_text('stamp,joint,x,y,z\n17,nose,0,0,1\n')
    assert 'line 2: the vocabulary lsc_pose has no joint' in fails(
        capsys, *begin, 'csv', '--source', table
    )
    table.write_text('stamp,joint,u,v\n17,l_wrist,0,0\n')
    assert 'take --joints lsc_pose' in fails(capsys, *begin, 'keypoints', '--source', table)
    table.write_text('stamp,joint,x,y,z\n17,head,0,0,1\n')
    assert '--time-offset' in fails(capsys, *begin, 'csv', '--source', table)
    table.write_text('stamp,joint,x,y\n')
    assert 'has no column z' in fails(capsys, *begin, 'csv', '--source', table)
    assert '--frames' in fails(capsys, *begin, 'tf')
    assert '--extrinsic' in fails(capsys, *begin, 'bvh', '--source', table)
    assert 'no topic' in fails(capsys, *begin, 'markers')
    assert 'comes with the package' in fails(
        capsys, *begin, 'csv', '--source', table, '--joints', 'kinekt'
    )
    assert not output.exists()
    assert list(tmp_path.glob('.*')) == []


@pytest.mark.parametrize('name', vocabularies())
def test_vocabularies_of_the_package_are_symmetric(name):
    vocabulary = load_vocabulary(name)
    assert {'head', 'neck', 'torso', 'l_shoulder', 'l_knee'} <= set(vocabulary.joints)
    for joint, source in vocabulary.joints.items():
        if joint.startswith('l_'):
            other = vocabulary.joints['r_' + joint[2:]]
            assert sorted(source.weights.values()) == sorted(other.weights.values())
            assert np.allclose(np.array(source.offset) * (1, -1, 1), other.offset)


def test_offsets_turn_with_the_body():
    vocabulary = load_vocabulary('kinect_v1')
    joints = pose(0.0)
    turn = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])  # about the vertical
    shift = vocabulary.with_offsets(joints) - joints
    turned = vocabulary.with_offsets(joints @ turn.T) - joints @ turn.T
    np.testing.assert_allclose(turned, shift @ turn.T, atol=1e-5)
    # This person faces the camera: forward is -z, up is -y.
    pelvis = shift[JOINT_NUMBERS['pelvis']]
    np.testing.assert_allclose(pelvis, [0, 0.14, 0.07], atol=1e-5)
