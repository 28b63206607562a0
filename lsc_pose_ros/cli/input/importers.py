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

"""What `lsc_pose import` can read besides UTD-MHAD: arguments and writing of each."""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS
from lsc_pose_ros.cli.options.numbers import SCALES, number_between, positive_int
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.datasets.image_folder import image_frames, open_image_folder
from lsc_pose_ros.datasets.itop import import_itop
from lsc_pose_ros.datasets.msr_action3d import import_msr
from lsc_pose_ros.datasets.msr_action3d_files import find_msr_sequences
from lsc_pose_ros.datasets.ntu_rgbd import find_sequences, import_ntu
from lsc_pose_ros.datasets.ros1_bag import Ros1Bag
from lsc_pose_ros.errors import InputError

_MILLIMETRE = 0.001


class Importer(NamedTuple):
    """One data set or format.

    Attributes:
        help: its line in the list.
        description: what is read.
        add_arguments: adds its arguments.
        write: writes the recording and returns what it contains, in words.
        labelled: whether the recording has labels.
    """

    help: str
    description: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    write: Callable[[argparse.Namespace, RecordingWriter], str]
    labelled: bool


def _add_paths(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument('directory', type=Path, metavar='SOURCE', help=what)
    parser.add_argument(
        'output', type=Path, metavar='OUT', help='the recording: OUT.mcap, or a bag folder'
    )


def _write(frames: Iterable[Frame], writer: RecordingWriter, *, mask: bool = True) -> str:
    topics = DEFAULT_TOPICS if mask else DEFAULT_TOPICS._replace(mask='')
    count = 0
    with writer:
        for frame in progress(frames, None, 'importing'):
            writer.write_frame(frame, topics)
            count += 1
        if not count:
            msg = 'there is no frame to import'
            raise InputError(msg)
    return f'{count} frames'


def _add_images(parser: argparse.ArgumentParser) -> None:
    _add_paths(parser, 'the folder of the depth images, 16-bit PNG')
    parser.add_argument(
        '--intrinsics',
        type=Path,
        metavar='JSON',
        help='fx, fy, cx, cy of the images, or K (default: the only .json file of the folder)',
    )
    parser.add_argument(
        '--masks', type=Path, metavar='DIR', help='masks with the names of the images; 0 is nobody'
    )
    parser.add_argument(
        '--scale',
        type=number_between(float, *SCALES),
        default=_MILLIMETRE,
        metavar='METRES',
        help='metres per unit of a pixel (default: %(default)s)',
    )
    parser.add_argument(
        '--fps',
        type=number_between(float, 0.001, 100_000),
        default=30.0,
        metavar='RATE',
        help='images per second, if the names are not stamps (default: %(default)s)',
    )


def _write_images(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    folder = open_image_folder(
        arguments.directory,
        arguments.intrinsics,
        arguments.masks,
        arguments.scale,
        arguments.fps,
    )
    return _write(image_frames(folder), writer, mask=arguments.masks is not None)


def _add_ros1(parser: argparse.ArgumentParser) -> None:
    _add_paths(parser, 'the file .bag')


def _write_ros1(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    bag = Ros1Bag(arguments.directory)
    count = 0
    with writer:
        for message in progress(bag, None, 'importing'):
            writer.write(message.topic, message.type_name, message.log_time, message.data)
            count += 1
        if not count:
            msg = f'{arguments.directory} has no message of a type that ROS 2 has'
            raise InputError(msg)
    words = f'{count} messages'
    if bag.left_out:
        kinds = ', '.join(f'{number} {name}' for name, number in bag.left_out.most_common(5))
        words += f'; left out, because ROS 2 does not have their types: {kinds}'
    return words


def _add_itop(parser: argparse.ArgumentParser) -> None:
    _add_paths(parser, 'the file NAME_depth_map.h5, with NAME_labels.h5 beside it')
    _add_stride(parser)


def _write_itop(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    return _write(import_itop(arguments.directory, arguments.stride), writer)


def _add_ntu(parser: argparse.ArgumentParser) -> None:
    _add_paths(parser, 'the folder of the .skeleton files')
    parser.add_argument(
        '--depth',
        type=Path,
        required=True,
        metavar='DIR',
        help='the folder of the masked depth maps, a folder for each sequence',
    )


def _write_ntu(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    sequences = find_sequences(arguments.directory, arguments.depth)
    left_out: Counter[str] = Counter()
    words = f'{_write(import_ntu(sequences, left_out), writer)} of {len(sequences)} sequences'
    if left_out:
        listed = ', '.join(f'{what} ({count})' for what, count in left_out.items())
        print(f'lsc_pose: warning: left out: {listed}', file=sys.stderr)
    return words


def _add_msr(parser: argparse.ArgumentParser) -> None:
    _add_paths(parser, 'the folder below which depth and both kinds of skeletons are unpacked')


def _write_msr(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    sequences = find_msr_sequences(arguments.directory)
    return f'{_write(import_msr(sequences), writer)} of {len(sequences)} sequences'


def _add_stride(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--stride',
        type=positive_int,
        default=1,
        metavar='N',
        help='use each Nth frame (default: %(default)s)',
    )


IMPORTERS = {
    'itop': Importer(
        'ITOP: one person, HDF5 files',
        'Convert a set of ITOP (side view) into a labelled recording; needs h5py.',
        _add_itop,
        _write_itop,
        labelled=True,
    ),
    'ntu-rgbd': Importer(
        'NTU RGB+D: people in front of a Kinect v2',
        'Convert sequences of NTU RGB+D into a labelled recording: .skeleton files and masked '
        'depth maps. Images and positions are mirrored back.',
        _add_ntu,
        _write_ntu,
        labelled=True,
    ),
    'msr-action3d': Importer(
        'MSR-Action3D: people who face a depth camera',
        'Convert sequences of MSR-Action3D into a labelled recording: the files _sdepth.bin, '
        '_skeleton3D.txt and _skeleton.txt. The unit of depth, the intrinsics, left and right, '
        'and whether images are mirrored are found by comparing them.',
        _add_msr,
        _write_msr,
        labelled=True,
    ),
    'images': Importer(
        'a folder of 16-bit PNG images with intrinsics',
        'Convert a folder of depth images into a recording, which `lsc_pose label` can label.',
        _add_images,
        _write_images,
        labelled=False,
    ),
    'rosbag1': Importer(
        'a bag of ROS 1',
        'Convert a bag of ROS 1 into a recording of ROS 2.',
        _add_ros1,
        _write_ros1,
        labelled=False,
    ),
}
"""The data sets and formats by the name that the command line has for them."""
