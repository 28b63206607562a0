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

"""Opens what the options of `lsc_pose label` name as the source of labels."""

import argparse
from pathlib import Path

from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.extrinsic import WORLD, Extrinsic, load_extrinsic
from lsc_pose_ros.labels.sources.bvh_file import bvh_tracks
from lsc_pose_ros.labels.sources.c3d_file import c3d_tracks
from lsc_pose_ros.labels.sources.keypoint_files import load_keypoints
from lsc_pose_ros.labels.sources.keypoints import KeypointLabels
from lsc_pose_ros.labels.sources.recorded_topics import (
    marker_samples,
    read_transform_history,
    skeleton_samples,
)
from lsc_pose_ros.labels.sources.table_file import csv_samples
from lsc_pose_ros.labels.sources.tf_frames import FrameLabels, load_joint_frames
from lsc_pose_ros.labels.tracks import (
    CAMERA_FRAME,
    BodyTrack,
    LabelSettings,
    LabelSource,
    TrackLabels,
    body_tracks,
)
from lsc_pose_ros.labels.transform_history import TransformHistory
from lsc_pose_ros.labels.vocabulary import OWN, load_vocabulary

SOURCES = {
    'tf': 'the frames of /tf that --frames names',
    'markers': 'a MarkerArray',
    'skeletons': 'a PointCloud2 of skeletons, as pose_node publishes them',
    'keypoints': 'keypoints in the depth image: CSV, JSON, or a folder of OpenPose',
    'csv': 'positions in a CSV file',
    'bvh': 'BVH files, one for each body',
    'c3d': 'a C3D file',
}

# The vocabulary of each source, if none is named.
_VOCABULARIES = {'markers': 'azure', 'keypoints': 'coco', 'c3d': 'plug_in_gait'}

_NEED_FILE = ('keypoints', 'csv', 'bvh', 'c3d')
_NEED_EXTRINSIC = ('bvh', 'c3d')

_SECOND = 1_000_000_000


def open_label_source(arguments: argparse.Namespace, first: Frame) -> LabelSource:
    """Return the source of labels that `arguments` name.

    Args:
        arguments: the command line.
        first: the first frame of the recording that is labelled.

    Raises:
        InputError: the source cannot be used, or an option is missing.
    """
    kind: str = arguments.source_kind
    _check(arguments)
    settings = LabelSettings(
        load_vocabulary(arguments.joints or _VOCABULARIES.get(kind, OWN)),
        round(arguments.max_gap * _SECOND),
        round(arguments.time_offset * _SECOND),
        arguments.anatomy,
    )
    if kind == 'keypoints':
        path = arguments.source[0]
        vocabulary, least = settings.vocabulary, arguments.min_confidence
        return KeypointLabels(load_keypoints(path, vocabulary, first.stamp, least), settings)
    extrinsic = load_extrinsic(arguments.extrinsic) if arguments.extrinsic else None
    recording = RecordingReader(_recorded_source(arguments))
    transforms = read_transform_history(recording, settings.longest_gap)
    if extrinsic is not None:
        extrinsic.add_to(transforms, first.frame_id)
    if kind == 'tf':
        bodies = load_joint_frames(arguments.frames, settings.vocabulary)
        return FrameLabels(bodies, transforms, settings)
    return _track_labels(arguments, first, recording, (transforms, settings, extrinsic))


def _track_labels(
    arguments: argparse.Namespace,
    first: Frame,
    recording: RecordingReader,
    context: tuple[TransformHistory, LabelSettings, Extrinsic | None],
) -> TrackLabels:
    transforms, settings, extrinsic = context
    tracks = _tracks(arguments, settings, recording, _frame_of_files(extrinsic), first.stamp)
    if not tracks:
        msg = f'--from {arguments.source_kind}: no joint of {settings.vocabulary.path.stem} found'
        raise InputError(msg)
    return TrackLabels(tracks, transforms, settings)


def _tracks(
    arguments: argparse.Namespace,
    settings: LabelSettings,
    recording: RecordingReader,
    frame_id: str,
    start: int,
) -> list[BodyTrack]:
    kind, vocabulary = arguments.source_kind, settings.vocabulary
    if kind == 'bvh':
        scale = arguments.scale or 1.0
        return bvh_tracks(arguments.source, vocabulary, frame_id, scale, start)
    if kind == 'c3d':
        return c3d_tracks(arguments.source[0], vocabulary, frame_id, arguments.scale, start)
    if kind == 'csv':
        scale = arguments.scale or 1.0
        samples = csv_samples(arguments.source[0], vocabulary, frame_id, scale, start)
    elif kind == 'markers':
        samples = marker_samples(recording, arguments.topic, vocabulary)
    else:
        least = arguments.min_confidence
        samples = skeleton_samples(recording, arguments.topic, vocabulary, least)
    return body_tracks(samples, vocabulary)


def _frame_of_files(extrinsic: Extrinsic | None) -> str:
    return CAMERA_FRAME if extrinsic is None else extrinsic.parent or WORLD


def _recorded_source(arguments: argparse.Namespace) -> Path:
    """Return the recording with topics and transforms: another one if --source names it."""
    if arguments.source_kind in _NEED_FILE or not arguments.source:
        return Path(arguments.recording)
    return Path(arguments.source[0])


def _check(arguments: argparse.Namespace) -> None:
    kind = arguments.source_kind
    if kind == 'tf' and arguments.frames is None:
        msg = '--from tf: name the frames of the joints with --frames MAPPING.yaml'
        raise InputError(msg)
    if kind in _NEED_FILE and not arguments.source:
        msg = f'--from {kind}: name the file with --source'
        raise InputError(msg)
    if kind != 'bvh' and len(arguments.source or []) > 1:
        msg = f'--from {kind} has one --source; only bvh has a file for each body'
        raise InputError(msg)
    if kind in _NEED_EXTRINSIC and arguments.extrinsic is None:
        msg = f'--from {kind}: give the pose of the camera in the file with --extrinsic'
        raise InputError(msg)
