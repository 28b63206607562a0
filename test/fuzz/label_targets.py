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

"""The readers of labels of other programs, each with good bytes to change.

What they read is also put into the frames, as `lsc_pose label` does.
"""

import importlib.util
import io
import json
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.datasets.image_folder import read_intrinsics
from lsc_pose_ros.labels.extrinsic import load_extrinsic
from lsc_pose_ros.labels.sources.bvh_file import bvh_tracks
from lsc_pose_ros.labels.sources.c3d_file import c3d_tracks
from lsc_pose_ros.labels.sources.keypoint_files import load_keypoints
from lsc_pose_ros.labels.sources.keypoints import KeypointLabels
from lsc_pose_ros.labels.sources.table_file import csv_samples
from lsc_pose_ros.labels.sources.tf_frames import load_joint_frames
from lsc_pose_ros.labels.tracks import (
    CAMERA_FRAME,
    LabelSettings,
    LabelSource,
    TrackLabels,
    body_tracks,
)
from lsc_pose_ros.labels.transform_history import TransformHistory
from lsc_pose_ros.labels.vocabulary import Vocabulary, load_vocabulary

START = 1_700_000_000_000_000_000
GAP = 100_000_000


class LabelTarget(NamedTuple):
    """A reader of a file: the name of the file, bytes that it can read, and the reader."""

    name: str
    seeds: list[bytes]
    read: Callable[[Path], object]


def _frames() -> list[Frame]:
    depth = np.full((12, 16), 2.0, np.float32)
    labels = np.full((12, 16), NO_BODY, np.int32)
    camera = Intrinsics(60.0, 60.0, 7.5, 5.5)
    return [
        Frame(START + number * GAP, 'camera', depth, labels, camera, None) for number in range(3)
    ]


def _put_into_frames(source: LabelSource) -> None:
    for number, frame in enumerate(_frames()):
        if not len(source.at(number, frame).bodies):
            source.why_none(number, frame)
    list(source.warnings)


def _settings(vocabulary: Vocabulary) -> LabelSettings:
    return LabelSettings(vocabulary, GAP)


def _put_tracks(read: Callable[[Path, Vocabulary], Any], name: str, path: Path) -> None:
    vocabulary = load_vocabulary(name)
    tracks = read(path, vocabulary)
    _put_into_frames(TrackLabels(tracks, TransformHistory(GAP), _settings(vocabulary)))


def _csv(path: Path, vocabulary: Vocabulary) -> Any:
    return body_tracks(csv_samples(path, vocabulary, CAMERA_FRAME, 1.0, START), vocabulary)


def _bvh(path: Path, vocabulary: Vocabulary) -> Any:
    return bvh_tracks([path], vocabulary, CAMERA_FRAME, 0.01, START)


def _c3d(path: Path, vocabulary: Vocabulary) -> Any:
    return c3d_tracks(path, vocabulary, CAMERA_FRAME, None, START)


def _put_keypoints(path: Path) -> None:
    vocabulary = load_vocabulary('coco')
    keypoints = load_keypoints(path, vocabulary, START, 0.0)
    _put_into_frames(KeypointLabels(keypoints, _settings(vocabulary)))


def _put_openpose(path: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, 'video_000000000001_keypoints.json').write_bytes(path.read_bytes())
        _put_keypoints(Path(folder))


TABLE = """stamp,body,joint,x,y,z
1700000000.000,1,head,0.1,-0.2,2.0
1700000000.000,1,neck,0.1,0,2.0
1700000000100000000,1,0,0.1,,nan
1700000000.2,2,head,1e-1,0.5,+2
"""

PIXELS = """frame,body,joint,u,v,confidence
0,1,nose,3.5,4,0.9
0,1,left_eye,4,4,
1,2,nose,3.5,4,0.1
"""

BVH = """HIERARCHY
ROOT pelvis
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation
  JOINT head
  {
    OFFSET 0 60 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 10 5
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.1
1 2 3 0 0 0 90
4 5 6 90 0 0 0
"""

EXTRINSIC = b'parent: world\ntranslation: [1, 2, 3]\nrotation: [-0.5, 0.5, -0.5, 0.5]\n'

VOCABULARY = b"""names: [HEAD, C7, CLAV, LASI, RASI]
joints_per_body: 100
joints:
  head: HEAD
  neck: [C7, CLAV]
  l_hip: {of: {LASI: 0.86, RASI: 0.14}, offset: [-0.05, 0, -0.075]}
"""

FRAMES = [
    b'bodies:\n  1:\n    head: {frame: a/Head, offset: [0, 0.05, 0]}\n    l_elbow: a/Arm\n',
    b"bodies: [1, 2]\npattern: '{joint}_{body}'\n",
]


def _people() -> list[list[float]]:
    return [[2.0 + number, 3.0, 0.5] * 17 for number in range(2)]


def _coco() -> bytes:
    first, second = _people()
    return json.dumps(
        [
            {'image_id': 0, 'keypoints': first},
            {'image_id': START + GAP, 'keypoints': second, 'track_id': 7},
        ]
    ).encode()


def _openpose() -> bytes:
    people = [{'pose_keypoints_2d': each} for each in _people()]
    return json.dumps({'version': 1.3, 'people': people}).encode()


def c3d_bytes() -> bytes:
    """Return a C3D file of two points in three frames."""
    import c3d  # noqa: PLC0415 - an optional dependency

    writer = c3d.Writer(point_rate=10.0, point_units='mm ')
    writer.set_point_labels(['LFHD', 'RFHD'])
    points = np.array([[1.0, 2.0, 3.0, 0.0, 0.0], [4.0, 5.0, 6.0, 0.0, 0.0]], np.float32)
    writer.add_frames([(points, np.array([[]]))] * 3)
    stream = io.BytesIO()
    writer.write(stream)
    return stream.getvalue()


def label_targets() -> dict[str, LabelTarget]:
    """Return the readers by name; without the package c3d, without that of C3D files."""
    found = {
        'labels csv': LabelTarget(
            'k.csv', [TABLE.encode()], partial(_put_tracks, _csv, 'lsc_pose')
        ),
        'labels bvh': LabelTarget('k.bvh', [BVH.encode()], partial(_put_tracks, _bvh, 'lsc_pose')),
        'keypoints csv': LabelTarget('k.csv', [PIXELS.encode()], _put_keypoints),
        'keypoints coco': LabelTarget('k.json', [_coco()], _put_keypoints),
        'keypoints openpose': LabelTarget('k.json', [_openpose()], _put_openpose),
        'extrinsic': LabelTarget('k.yaml', [EXTRINSIC], load_extrinsic),
        'vocabulary': LabelTarget('k.yaml', [VOCABULARY], load_vocabulary),
        'frames of joints': LabelTarget(
            'k.yaml', FRAMES, lambda path: load_joint_frames(path, load_vocabulary('lsc_pose'))
        ),
        'intrinsics': LabelTarget(
            'k.json', [b'{"fx": 570.3, "fy": 570.3, "cx": 319.5, "cy": 239.5}',
                       b'{"K": [1, 0, 2, 0, 1, 2, 0, 0, 1]}'], read_intrinsics,
        ),
    }  # fmt: skip
    if importlib.util.find_spec('c3d'):
        found['labels c3d'] = LabelTarget(
            'k.c3d', [c3d_bytes()], partial(_put_tracks, _c3d, 'plug_in_gait')
        )
    return found
