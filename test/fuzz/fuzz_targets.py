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

"""What reads bytes from strangers, each with good bytes to change."""

import sqlite3
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.serialization.deserialize import (
    read_camera_info,
    read_compressed_image,
    read_image,
    read_skeletons,
    read_transforms,
)
from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    mask_message,
    serialize,
    skeletons_message,
    transforms_message,
)
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.body_parts.part_network import INPUTS, OUTPUTS, Layer, PartNetwork
from lsc_pose_ros.data_types.camera import Intrinsics, Lens
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.codecs.compressed_depth import (
    decode_compressed_depth,
    encode_compressed_depth,
)
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout, decode_depth, decode_mask
from lsc_pose_ros.messages.codecs.png import read_png, write_png
from lsc_pose_ros.messages.codecs.rvl import decode_rvl, encode_rvl
from lsc_pose_ros.messages.image_pixels import depth_of, labels_of
from lsc_pose_ros.messages.transforms import Transform
from lsc_pose_ros.messages.type_names import COMPRESSED_IMAGE
from lsc_pose_ros.model_io.model_file import load_model, save_model
from lsc_pose_ros.model_io.part_network_file import (
    _MIXES,
    _SOURCES,
    load_part_network,
    save_part_network,
)
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.mocap_mapping import load_mapping
from lsc_pose_ros.training.checkpoint import FinishedTree, Limits
from lsc_pose_ros.training.checkpoint_file import CheckpointFile

from label_targets import label_targets  # isort: skip
from tiny_model import tiny_model  # isort: skip

STAMP = 1_700_000_000_000_000_000
CAMERA = Intrinsics(60.0, 60.0, 31.5, 23.5, Lens('plumb_bob', (0.1, 0.0, 0.0, 0.0, 0.0)))
SHAPE = (12, 16)


class Target(NamedTuple):
    """A reader of bytes.

    Attributes:
        seeds: bytes that it can read.
        read: reads bytes; it may raise InputError.
        archive: whether the parts of an archive are changed, and not its compressed bytes.
    """

    seeds: list[bytes]
    read: Callable[[bytes], object]
    archive: bool = False


def read_checkpoint(path: Path) -> None:
    """Read the trees of a checkpoint of `tiny_model`."""
    model = tiny_model()
    limits = Limits(model.feature_size, len(model.joints), len(model.edges))
    CheckpointFile(path, 'program', resume=True).load('key', limits, 2)


def checkpoint(path: Path) -> None:
    """Write a checkpoint with the first tree of `tiny_model`, twice."""
    forest = tiny_model().forest
    tree = FinishedTree._make([*forest[1:]])
    CheckpointFile(path, 'program', resume=True).store('key', [tree, tree])


def through_file(name: str, read: Callable[[Path], object]) -> Callable[[bytes], object]:
    """Return what writes bytes to a file of this name and reads it."""

    def act(data: bytes) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, name)
            path.write_bytes(data)
            read(path)

    return act


def frame(number: int = 0) -> Frame:
    """Return a small labelled frame."""
    depth = np.full(SHAPE, 4.0, np.float32)
    labels = np.full(SHAPE, NO_BODY, np.int32)
    depth[2:10, 3:9], labels[2:10, 3:9] = 2.0, 1
    joints = Skeletons(
        np.array([1], np.uint16), np.array([0, 1], np.uint16),
        np.ones((1, 2, 3), np.float32), np.ones((1, 2), np.float32),
    )  # fmt: skip
    return Frame(STAMP + number * 33_000_000, 'camera', depth, labels, CAMERA, joints)


def written(name: str, write: Callable[[Path], object]) -> bytes:
    """Return the bytes of the file that `write` writes."""
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder, name))
        return Path(folder, name).read_bytes()


def recording(path: Path) -> None:
    """Write a small recording."""
    with RecordingWriter(path) as writer:
        for number in range(3):
            writer.write_frame(frame(number))


def sqlite_recording(path: Path) -> None:
    """Write the same messages as a database, as rosbag2 does."""
    with tempfile.TemporaryDirectory() as folder:
        recording(Path(folder, 'k.mcap'))
        messages = list(read_messages(Path(folder, 'k.mcap')))
    topics = {message.topic: message.type_name for message in messages}
    with sqlite3.connect(path) as database:
        database.execute(
            'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, '
            'serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)'
        )
        database.execute(
            'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, '
            'timestamp INTEGER NOT NULL, data BLOB NOT NULL)'
        )
        numbers = {name: number for number, name in enumerate(topics, 1)}
        for name, kind in topics.items():
            row = (numbers[name], name, kind, 'cdr', '')
            database.execute('INSERT INTO topics VALUES (?, ?, ?, ?, ?)', row)
        for message in messages:
            values = (numbers[message.topic], message.log_time, message.data)
            database.execute(
                'INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)', values
            )
    database.close()


def read_recording(path: Path) -> None:
    """Read all messages and all frames."""
    for _ in read_messages(path):
        pass
    for _ in open_recording(path):
        pass


def read_bag_with(metadata: bytes) -> None:
    """Read a bag folder with this metadata.yaml."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder, 'bag')
        bag.mkdir()
        (bag / 'bag.mcap').write_bytes(_recording_bytes())
        (bag / 'metadata.yaml').write_bytes(metadata)
        reader = read_messages(bag)
        assert sum(1 for _ in reader) == len(list(read_messages(bag / 'bag.mcap')))
        assert len(str(reader.warnings)) < 10_000
        sorted(reader.topics)


@cache
def _recording_bytes() -> bytes:
    return written('k.mcap', recording)


def bag_metadata() -> bytes:
    """Return the metadata.yaml of a bag folder."""
    with tempfile.TemporaryDirectory() as folder:
        recording(Path(folder, 'bag'))
        return Path(folder, 'bag', 'metadata.yaml').read_bytes()


def aliased_metadata() -> bytes:
    """Return a metadata.yaml whose aliases stand for 2^30 letters."""
    lists = ['&a0 [z, z]', *(f'&a{n} [*a{n - 1}, *a{n - 1}]' for n in range(1, 30))]
    return bag_metadata().replace(b'version: 9', f'version: [{", ".join(lists)}]'.encode())


SHORT_METADATA = b"""rosbag2_bagfile_information:
  version: 9
  relative_file_paths: [bag.mcap, bag/b.mcap.zstd]
  topics_with_message_count:
    - topic_metadata: {name: /mask, type: sensor_msgs/msg/Image, offered_qos_profiles: "a: 1"}
      message_count: 3
"""


def read_any_message(data: bytes) -> None:
    """Read a message: the first byte says of which type."""
    kind, message = (data[0] if data else 0) % 6, data[1:]
    if kind == 0:
        depth_of(read_image(message))
    elif kind == 1:
        read_camera_info(message)
    elif kind == 2:
        read_skeletons(message)
    elif kind == 3:
        read_transforms(message)
    elif kind == 4:
        labels_of(read_compressed_image(message), 0)
    else:
        labels_of(read_image(message), 0)


def messages() -> list[bytes]:
    """Return a message of each type, after the byte of `read_any_message`."""
    good = frame()
    head = (STAMP, 'camera')
    types = typestore().types
    compressed = types[COMPRESSED_IMAGE](
        header=types['std_msgs/msg/Header'](
            stamp=types['builtin_interfaces/msg/Time'](sec=1, nanosec=2), frame_id='camera'
        ),
        format='png',
        data=np.frombuffer(write_png(np.ones(SHAPE, np.uint8)), np.uint8),
    )
    turn = Transform('base', 'camera', (0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0))
    return [
        b'\0' + depth_message(*head, good.depth),
        b'\5' + mask_message(*head, good.labels, 0),
        b'\1' + camera_info_message(*head, CAMERA, SHAPE),
        b'\2' + skeletons_message(*head, good.ground_truth),
        b'\3' + transforms_message(STAMP, [turn]),
        b'\4' + serialize(compressed, COMPRESSED_IMAGE),
    ]


_LAYOUT = np.dtype([('height', '<u4'), ('width', '<u4'), ('step', '<u4'), ('kind', 'u1')])
_ENCODINGS = ('16UC1', 'mono16', '32FC1', 'mono8', '8UC1', '32SC1', 'rgb8')


def read_layout(data: bytes) -> None:
    """Read an image: a layout, then the pixels."""
    if len(data) < _LAYOUT.itemsize:
        return
    height, width, step, kind = np.frombuffer(data, _LAYOUT, 1)[0].tolist()
    layout = ImageLayout(
        _ENCODINGS[kind % len(_ENCODINGS)], height, width, step, big_endian=kind >= 128
    )
    decode = decode_mask if kind & 64 else decode_depth
    decode(data[_LAYOUT.itemsize :], layout)


def read_rvl(data: bytes) -> None:
    """Read an RVL stream: the first byte is the number of pixels."""
    if data:
        decode_rvl(data[1:], data[0])


def part_network(path: Path) -> None:
    """Write a small network of body parts: each layer has one plane, but the last one."""
    layers = {}
    for name, source in _SOURCES.items():
        planes = OUTPUTS if name == 'scores' else 1
        shape = (planes, INPUTS if source is None else 1, *(() if name in _MIXES else (9,)))
        layers[name] = Layer(np.ones(shape, np.float32), np.zeros(planes, np.float32))
    save_part_network(path, PartNetwork(**layers), {'made': 'by hand'})


BVH = b"""HIERARCHY
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


def targets() -> dict[str, Target]:
    """Return all targets by name."""
    millimetres = np.arange(np.prod(SHAPE), dtype=np.uint16).reshape(SHAPE) * 37
    metres = millimetres.astype(np.float32) / 1000
    compressed = {
        codec: [encode_compressed_depth(pixels, codec)[1] for pixels in (millimetres, metres)]
        for codec in ('png', 'rvl')
    }
    layout = np.array([(*SHAPE, 32, 0)], _LAYOUT).tobytes()
    return {
        'image': Target([layout + millimetres.tobytes()], read_layout),
        'png': Target([write_png(millimetres), write_png(millimetres.astype(np.uint8))], read_png),
        'rvl': Target([bytes([millimetres.size]) + encode_rvl(millimetres)], read_rvl),
        **{
            f'compressedDepth {codec} {encoding}': Target(
                seeds,
                partial(
                    decode_compressed_depth, format_text=f'{encoding}; compressedDepth {codec}'
                ),
            )
            for codec, seeds in compressed.items()
            for encoding in ('16UC1', '32FC1')
        },
        'cdr': Target(messages(), read_any_message),
        'model': Target(
            [written('m.npz', lambda path: save_model(path, tiny_model()))],
            through_file('m.npz', load_model),
            archive=True,
        ),
        'checkpoint': Target(
            [written('c.npz', checkpoint)], through_file('c.npz', read_checkpoint), archive=True
        ),
        'body parts': Target(
            [written('p.npz', part_network)],
            through_file('p.npz', load_part_network),
            archive=True,
        ),
        'mcap': Target([written('k.mcap', recording)], through_file('k.mcap', read_recording)),
        'sqlite': Target(
            [written('k.db3', sqlite_recording)], through_file('k.db3', read_recording)
        ),
        'metadata': Target([bag_metadata(), aliased_metadata(), SHORT_METADATA], read_bag_with),
        'bvh': Target([BVH], through_file('k.bvh', lambda path: joint_poses(load_bvh(path)))),
        'mapping': Target(
            [resource('config', 'mocap', 'cmu.yaml').read_bytes()],
            through_file('k.yaml', load_mapping),
        ),
        **{
            name: Target(each.seeds, through_file(each.name, each.read))
            for name, each in label_targets().items()
        },
    }
