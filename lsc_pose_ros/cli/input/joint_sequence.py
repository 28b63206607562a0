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

"""Reads the skeletons of a topic of a recording, in the frame that is asked for."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.bags.serialization.deserialize import DamagedMessageError, read_as
from lsc_pose_ros.cli.input.recorded_skeletons import find_skeletons_topic
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.checks.study import with_all_joints
from lsc_pose_ros.labels.sources.recorded_topics import read_transform_history
from lsc_pose_ros.messages.label_messages import parse_framed_skeletons
from lsc_pose_ros.messages.type_names import POINT_CLOUD

# Transforms of a robot come at least so often, nanoseconds.
_LONGEST_GAP = 500_000_000


class JointSequence(NamedTuple):
    """All bodies of a recording, N of them over all frames, in the order of time.

    Attributes:
        topic: where they are from.
        frame_id: the frame of the positions.
        stamps: of each body's frame, nanoseconds, shape (N,).
        bodies: their numbers, shape (N,).
        joints: the names of the J joints that occur.
        positions: metres, NaN if unknown, shape (N, J, 3).
        confidence: shape (N, J).
        without_pose: how many bodies were left out, because TF does not know the frame then.
        damaged: how many messages were left out, because they cannot be read.
    """

    topic: str
    frame_id: str
    stamps: NDArray[np.int64]
    bodies: NDArray[np.int64]
    joints: tuple[str, ...]
    positions: NDArray[np.float64]
    confidence: NDArray[np.float64]
    without_pose: int
    damaged: int


def read_joint_sequence(
    recording: RecordingReader, topic: str, ground_truth: str, frame: str
) -> JointSequence:
    """Return the skeletons of a recording.

    Args:
        recording: the recording.
        topic: of the skeletons; '' for the estimates, or else the ground truth.
        ground_truth: the topic of the ground truth, '' if there is none.
        frame: the frame of the positions, found by TF; '' for that of the camera.

    Raises:
        InputError: there are no skeletons, or none in this frame, or they are in several frames
            and none is asked for.
    """
    topic = topic or find_skeletons_topic(recording, '', ground_truth) or ground_truth
    if not topic:
        msg = f'{recording.path} has no skeletons; `lsc_pose replay -o` estimates them'
        raise InputError(msg)
    history = read_transform_history(recording, _LONGEST_GAP) if frame else None
    rows: list[tuple[int, int, NDArray[np.float64], NDArray[np.float64]]] = []
    frame_id, without_pose, damaged = frame, 0, 0
    for message in recording.select({topic}):
        try:
            stamp, source, skeletons = read_as(message.data, POINT_CLOUD, parse_framed_skeletons)
        except DamagedMessageError:
            damaged += 1
            continue
        if not frame and frame_id not in {'', source}:
            msg = (
                f'{recording.path}: the skeletons of {topic} are in the frames {frame_id} and '
                f'{source}; choose one with --frame'
            )
            raise InputError(msg)
        frame_id = frame or source
        skeletons = with_all_joints(skeletons)._replace(confidence=_confidence(skeletons))
        pose = history.lookup(frame, source, stamp) if history is not None else None
        if history is not None and pose is None:
            without_pose += len(skeletons.bodies)
            continue
        for row, body in enumerate(skeletons.bodies.tolist()):
            positions = skeletons.positions[row].astype(np.float64)
            positions = positions if pose is None else pose.apply(positions)
            rows.append((stamp, body, positions, skeletons.confidence[row].astype(np.float64)))
    if not rows:
        reason = f'TF does not know {frame} then' if without_pose else 'no body was found'
        msg = f'{recording.path}: {topic} has nothing to export: {reason}'
        raise InputError(msg)
    return _sequence(topic, frame_id, rows, without_pose, damaged)


def _confidence(skeletons: Skeletons) -> NDArray[np.float32]:
    """Return the confidence of all 20 joints, 0 for those that are not there, shape (B, 20)."""
    joints, confidence = skeletons.joints, skeletons.confidence
    full = np.zeros((len(confidence), len(JOINT_NAMES)), np.float32)
    full[:, joints.astype(int)] = confidence
    return full


def _sequence(
    topic: str,
    frame_id: str,
    rows: list[tuple[int, int, NDArray[np.float64], NDArray[np.float64]]],
    without_pose: int,
    damaged: int,
) -> JointSequence:
    rows.sort(key=lambda row: row[:2])
    positions = np.array([row[2] for row in rows])
    used = np.flatnonzero(np.isfinite(positions).all(axis=2).any(axis=0))
    return JointSequence(
        topic,
        frame_id,
        np.array([row[0] for row in rows], np.int64),
        np.array([row[1] for row in rows], np.int64),
        tuple(JOINT_NAMES[number] for number in used),
        positions[:, used],
        np.array([row[3] for row in rows])[:, used],
        without_pose,
        damaged,
    )
