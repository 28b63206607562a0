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

"""Importers of other data sets and formats, on files that these tests write."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.bags.serialization.deserialize import read_camera_info
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.datasets.image_folder import ImageFolder
from lsc_pose_ros.datasets.ntu_rgbd import read_skeleton_file
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.vocabulary import load_vocabulary

K = {'fx': 60.0, 'fy': 61.0, 'cx': 31.5, 'cy': 23.5}
EPOCH = 1_420_070_400 * 10**9


def write_images(folder, names):
    folder.mkdir()
    images = []
    for number, name in enumerate(names):
        pixels = np.full((48, 64), 2000 + number, np.uint16)
        pixels[:10] = 0
        Image.fromarray(pixels).save(folder / name)
        images.append(pixels)
    return images


def imported(tmp_path, *words):
    output = tmp_path / 'imported.mcap'
    assert (
        main(['import', words[0], *map(str, words[1:2]), str(output), *map(str, words[2:])]) == 0
    )
    return output


def test_images_with_intrinsics_and_masks(tmp_path):
    names = ['depth_9.png', 'depth_10.png']
    images = write_images(tmp_path / 'depth', names)
    masks = tmp_path / 'masks'
    masks.mkdir()
    mask = np.zeros((48, 64), np.uint8)
    mask[20:40, 20:40] = 3
    for name in names:
        Image.fromarray(mask).save(masks / name)
    (tmp_path / 'depth' / 'camera.json').write_text(json.dumps(K))
    output = imported(tmp_path, 'images', tmp_path / 'depth', '--masks', masks, '--fps', 10)
    frames = list(open_recording(output))
    assert [frame.stamp for frame in frames] == [EPOCH, EPOCH + 10**8]
    for frame, pixels in zip(frames, images, strict=True):
        np.testing.assert_allclose(frame.depth, pixels / 1000, atol=1e-6)
        assert (frame.labels == np.where(mask > 0, 3, NO_BODY)).all()
        assert frame.camera[:4] == tuple(K.values())


@pytest.mark.parametrize(
    ('table', 'names', 'stamps'),
    [
        (
            {'width': 64, 'height': 48, 'intrinsic_matrix': [60, 0, 0, 0, 61, 0, 31.5, 23.5, 1]},
            ['1700000000.250000000.png', '1700000000.350000.png'],
            [1_700_000_000_250_000_000, 1_700_000_000_350_000_000],
        ),
        (
            {'K': [60, 0, 31.5, 0, 61, 23.5, 0, 0, 1]},
            ['1700000000250000001.png', '1700000000350000001.png'],
            [1_700_000_000_250_000_001, 1_700_000_000_350_000_001],
        ),
    ],
)
def test_images_with_stamps_as_names(tmp_path, table, names, stamps):
    write_images(tmp_path / 'depth', names)
    intrinsics = tmp_path / 'k.json'
    intrinsics.write_text(json.dumps(table))
    words = ['--intrinsics', intrinsics, '--scale', 0.0005]
    output = imported(tmp_path, 'images', tmp_path / 'depth', *words)
    frames = list(open_recording(output, need_mask=False))
    assert [frame.stamp for frame in frames] == stamps
    assert frames[0].depth.max() == pytest.approx(1.0)
    assert frames[0].camera[:4] == tuple(K.values())


def test_unusable_images_are_told(tmp_path, capsys):
    def fails(*words):
        assert main(['import', 'images', *map(str, words)]) == 2
        return capsys.readouterr().err

    output = tmp_path / 'out.mcap'
    assert 'there is no folder' in fails(tmp_path / 'nothing', output)
    folder = tmp_path / 'depth'
    write_images(folder, ['a.png'])
    assert 'name one with --intrinsics' in fails(folder, output)
    (folder / 'k.json').write_text('{"fx": 1}')
    assert 'has no intrinsics' in fails(folder, output)
    (folder / 'k.json').write_text(json.dumps(K))
    Image.fromarray(np.zeros((48, 64), np.uint8)).save(folder / 'b.png')
    assert '8 bits per pixel' in fails(folder, output)
    Image.fromarray(np.zeros((48, 60), np.uint16)).save(folder / 'b.png')
    assert 'has the size' in fails(folder, output)
    (folder / 'b.png').write_bytes(b'no image')
    assert 'cannot read the image' in fails(folder, output)
    assert not output.exists()


def ros1_bag(path):
    """A bag of ROS 1 with depth, camera info, /tf in the old type, and a type of its own."""
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg('int32 answer', 'robot_msgs/msg/Answer'))
    store.register(
        get_types_from_msg('geometry_msgs/TransformStamped[] transforms', 'tf/msg/tfMessage')
    )
    types = store.types
    header = types['std_msgs/msg/Header'](
        seq=4, stamp=types['builtin_interfaces/msg/Time'](sec=17, nanosec=5), frame_id='camera'
    )
    pixels = np.arange(1000, 1000 + 48 * 64, dtype='<u2').reshape(48, 64)
    image = types['sensor_msgs/msg/Image'](
        header=header, height=48, width=64, encoding='16UC1', is_bigendian=0, step=128,
        data=pixels.view(np.uint8).reshape(-1),
    )  # fmt: skip
    roi = types['sensor_msgs/msg/RegionOfInterest'](0, 0, 0, 0, do_rectify=False)
    info = types['sensor_msgs/msg/CameraInfo'](
        header=header, height=48, width=64, distortion_model='plumb_bob', D=np.zeros(5),
        K=np.array([60, 0, 31.5, 0, 61, 23.5, 0, 0, 1.0]), R=np.eye(3).ravel(), P=np.zeros(12),
        binning_x=0, binning_y=0, roi=roi,
    )  # fmt: skip
    transform = types['geometry_msgs/msg/TransformStamped'](
        header=header,
        child_frame_id='hand',
        transform=types['geometry_msgs/msg/Transform'](
            translation=types['geometry_msgs/msg/Vector3'](1.0, 2.0, 3.0),
            rotation=types['geometry_msgs/msg/Quaternion'](0.0, 0.0, 0.0, 1.0),
        ),
    )
    messages = [
        ('/depth/image', 'sensor_msgs/msg/Image', image),
        ('/depth/camera_info', 'sensor_msgs/msg/CameraInfo', info),
        ('/tf', 'tf/msg/tfMessage', types['tf/msg/tfMessage'](transforms=[transform])),
        ('/answer', 'robot_msgs/msg/Answer', types['robot_msgs/msg/Answer'](answer=42)),
    ]
    with Writer(path) as writer:
        for topic, kind, message in messages:
            connection = writer.add_connection(topic, kind, typestore=store)
            writer.write(connection, 17 * 10**9, store.serialize_ros1(message, kind))
    return pixels


def test_bag_of_ros_1(tmp_path, capsys):
    pixels = ros1_bag(tmp_path / 'old.bag')
    output = imported(tmp_path, 'rosbag1', tmp_path / 'old.bag')
    assert '1 robot_msgs/msg/Answer' in capsys.readouterr().out
    frame = next(iter(open_recording(output, need_mask=False)))
    assert frame.stamp == 17 * 10**9 + 5
    np.testing.assert_allclose(frame.depth, pixels / 1000, atol=1e-6)
    assert frame.camera.fx == 60
    topics = RecordingReader(output).topics
    assert topics['/tf'].type_name == 'tf2_msgs/msg/TFMessage'
    info = next(RecordingReader(output).select({'/depth/camera_info'}))
    assert read_camera_info(info.data).camera.cy == 23.5


def test_file_that_is_no_bag_of_ros_1(tmp_path, capsys):
    path = tmp_path / 'wrong.bag'
    path.write_bytes(b'#ROSBAG V2.0\nnothing')
    output = tmp_path / 'out.mcap'
    assert main(['import', 'rosbag1', str(path), str(output)]) == 2
    assert 'cannot be read as a bag of ROS 1' in capsys.readouterr().err
    assert not output.exists()


# NTU RGB+D: two people, one beside the other, in the mirrored axes of the Kinect.
FX, FY, CX, CY = 366.0, 365.0, 256.5, 205.0


def ntu_body(x):
    random = np.random.default_rng(1)
    return random.uniform([-0.3, -0.8, -0.05], [0.3, 0.8, 0.05], (25, 3)) + np.array([x, 0, 3])


def kinect_pixel(joint):
    return CX + FX * joint[0] / joint[2], CY - FY * joint[1] / joint[2]


def write_ntu(folder, count):
    bodies = [ntu_body(-0.6), ntu_body(0.6)]
    lines = [str(count)]
    for _ in range(count):
        lines.append(str(len(bodies)))
        for body in bodies:
            lines += ['72057594037931101 0 1 1 1 1 0 0.01 0.02 2', '25']
            for index, joint in enumerate(body):
                values = (*joint, *kinect_pixel(joint), 900.0, 500.0, 0, 0, 0, 1)
                lines.append(
                    ' '.join(f'{value:.7f}' for value in values) + f' {0 if index == 7 else 2}'
                )
    name = 'S001C001P001R001A001'
    (folder / f'{name}.skeleton').write_text('\n'.join(lines) + '\n')
    images = folder / name
    images.mkdir()
    depth = np.zeros((424, 512), np.uint16)
    for body in bodies:
        for joint in body:
            column, row = (round(each) for each in kinect_pixel(joint))
            depth[row - 6 : row + 7, column - 6 : column + 7] = round(1000 * joint[2]) - 50
    for number in range(1, count + 1):
        Image.fromarray(depth).save(images / f'MDepth-{number:08d}.png')
    return bodies


def test_ntu_rgbd_images_keep_their_skeletons_if_some_are_missing(tmp_path, capsys):
    write_ntu(tmp_path, 4)
    words = ['--depth', tmp_path, '--no-check']
    whole = list(open_recording(imported(tmp_path, 'ntu-rgbd', tmp_path, *words)))
    images = tmp_path / 'S001C001P001R001A001'
    last = images / 'MDepth-00000004.png'
    shutil.copy(last, images / 'MDepth-00000005.png')
    shutil.copy(last, images / 'MDepth-00000006.png')
    (images / 'MDepth-00000002.png').unlink()
    (tmp_path / 'imported.mcap').unlink()
    capsys.readouterr()
    frames = list(open_recording(imported(tmp_path, 'ntu-rgbd', tmp_path, *words)))
    assert [frame.stamp for frame in frames] == [whole[n].stamp for n in (0, 2, 3)]
    said = capsys.readouterr().err
    assert 'left out: skeletons without an image (1), images without a skeleton (2)' in said


@pytest.mark.parametrize('number', ['inf', '1e300', '-1', '0', '0.5'])
def test_ntu_rgbd_with_an_absurd_number_of_frames_is_refused(number, tmp_path):
    path = tmp_path / 'k.skeleton'
    path.write_text(f'{number}\n0\n')
    with pytest.raises(InputError, match=r'k\.skeleton'):
        read_skeleton_file(path)


@pytest.mark.parametrize('rate', [1e-3, 1e5])
def test_images_with_names_that_are_no_stamps_have_the_rate(rate, tmp_path):
    paths = [tmp_path / f'{"9" * 200}_{number}{"9" * 20}.png' for number in range(3)]
    stamps = ImageFolder(paths, Intrinsics(1, 1, 0, 0), None, 0.001, rate).stamps
    assert np.diff(stamps).tolist() == [round(1e9 / rate)] * 2
    assert stamps[0] == EPOCH


def test_ntu_rgbd_is_mirrored_back(tmp_path):
    bodies = write_ntu(tmp_path, 3)
    words = ['--depth', tmp_path, '--no-check']
    output = imported(tmp_path, 'ntu-rgbd', tmp_path, *words)
    frames = list(open_recording(output))
    assert len(frames) == 3
    camera = frames[0].camera
    np.testing.assert_allclose(camera[:4], [FX, FY, 511 - CX, CY], atol=1e-2)
    vocabulary = load_vocabulary('kinect_v2')
    truth = frames[1].ground_truth
    assert truth.bodies.tolist() == [1, 2]
    for positions, body in zip(truth.positions, bodies, strict=True):
        for name, source in vocabulary.joints.items():
            index = vocabulary.names.index(next(iter(source.weights)))
            found = positions[JOINT_NUMBERS[name]]
            if index == 7:  # not tracked
                assert np.isnan(found).all()
            else:
                np.testing.assert_allclose(found, body[index] * (-1, -1, 1), atol=1e-5)
    # Each body is where its joints are: the first one, at negative X, is at image right now.
    for number, positions in zip((1, 2), truth.positions, strict=True):
        known = positions[np.isfinite(positions).all(axis=1)]
        columns, rows = np.rint(project(known, camera)).astype(int).T
        assert (frames[1].labels[rows, columns] == number).all()


def test_damaged_skeleton_files_are_told_with_their_line(tmp_path, capsys):
    write_ntu(tmp_path, 2)
    path = tmp_path / 'S001C001P001R001A001.skeleton'
    lines = path.read_text().splitlines()
    words = [
        'import',
        'ntu-rgbd',
        str(tmp_path),
        str(tmp_path / 'o.mcap'),
        '--depth',
        str(tmp_path),
    ]
    path.write_text('\n'.join(lines[:40]))
    assert main(words) == 2
    assert 'ends too early, at line 40' in capsys.readouterr().err
    lines[9] = '1 2 3'
    path.write_text('\n'.join(lines))
    assert main(words) == 2
    assert 'line 10: 3 numbers' in capsys.readouterr().err


def test_itop(tmp_path):
    h5py = pytest.importorskip('h5py')
    random = np.random.default_rng(4)
    positions = random.normal([0, 0, 3], 0.3, (4, 15, 3)).astype(np.float32)
    parts = np.full((4, 240, 320), -1, np.int8)
    parts[:, 60:200, 100:220] = 3
    depth = np.full((4, 240, 320), 3.5, np.float16)
    with h5py.File(tmp_path / 'ITOP_side_test_depth_map.h5', 'w') as file:
        file['data'] = depth
        file['id'] = np.array([b'00_00000', b'00_00001', b'00_00002', b'01_00003'])
    with h5py.File(tmp_path / 'ITOP_side_test_labels.h5', 'w') as file:
        file['id'] = np.array([b'00_00000', b'00_00001', b'00_00002', b'01_00003'])
        file['is_valid'] = np.array([1, 0, 1, 1], np.uint8)
        file['real_world_coordinates'] = positions
        file['segmentation'] = parts
    path = tmp_path / 'ITOP_side_test_depth_map.h5'
    frames = list(open_recording(imported(tmp_path, 'itop', path, '--no-check')))
    steps = [(frame.stamp - EPOCH) * 30 / 1e9 for frame in frames]
    assert steps == pytest.approx([0, 2, 100_003])
    vocabulary = load_vocabulary('itop')
    for frame, index in zip(frames, (0, 2, 3), strict=True):
        assert ((frame.labels == 1) == (parts[index] >= 0)).all()
        for name in JOINT_NAMES:
            found = frame.ground_truth.positions[0, JOINT_NUMBERS[name]]
            if name not in vocabulary.joints:
                assert np.isnan(found).all()
                continue
            source = vocabulary.names.index(next(iter(vocabulary.joints[name].weights)))
            expected = positions[index, source] * (1, -1, 1)
            np.testing.assert_allclose(found, expected, atol=1e-6)


def test_itop_needs_both_files(tmp_path, capsys):
    h5py = pytest.importorskip('h5py')
    path = tmp_path / 'ITOP_side_test_depth_map.h5'
    with h5py.File(path, 'w') as file:
        file['data'] = np.zeros((1, 240, 320))
    assert main(['import', 'itop', str(path), str(tmp_path / 'o.mcap')]) == 2
    assert 'both files of a set are needed' in capsys.readouterr().err
