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

"""Joints and transforms from the topics of a recording."""

from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import numpy as np

from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.bags.serialization.deserialize import DamagedMessageError, read_as
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.limits import LARGEST_BODY
from lsc_pose_ros.labels.tracks import JointSample
from lsc_pose_ros.labels.transform_history import TransformHistory
from lsc_pose_ros.labels.vocabulary import Vocabulary
from lsc_pose_ros.messages.label_messages import (
    parse_framed_skeletons,
    parse_marker_points,
    parse_stamped_transforms,
)
from lsc_pose_ros.messages.type_names import MARKER_ARRAY, POINT_CLOUD, TF_MESSAGE

_STATIC = 'tf_static'

_Values = TypeVar('_Values')


def read_transform_history(recording: RecordingReader, longest_gap: int) -> TransformHistory:
    """Return the transforms of all topics of type tf2_msgs/TFMessage.

    Args:
        recording: the recording.
        longest_gap: as `TransformHistory`.
    """
    history = TransformHistory(longest_gap)
    for name in _topics(recording, TF_MESSAGE):
        for transforms in _messages(recording, name, TF_MESSAGE, parse_stamped_transforms):
            for transform in transforms:
                history.add(transform, static=name.endswith(_STATIC))
    return history


def marker_samples(
    recording: RecordingReader, topic: str, vocabulary: Vocabulary
) -> Iterator[JointSample]:
    """Yield the joints in a topic of type visualization_msgs/MarkerArray.

    Args:
        recording: the recording.
        topic: its name; '' if the recording has only one.
        vocabulary: says how the markers are numbered.

    Raises:
        InputError: there is no such topic, it is ambiguous, or its markers are lists of points or
            have the numbers of no bodies.
    """
    topic = find_topic(recording, topic, MARKER_ARRAY)
    single = lists = 0
    for markers in _messages(recording, topic, MARKER_ARRAY, parse_marker_points):
        single += len(markers.points)
        lists += markers.lists
        for point in markers.points:
            per_body = vocabulary.joints_per_body
            if per_body:
                body, joint = divmod(point.identifier, per_body)
                known = 0 <= joint < len(vocabulary.names)
            else:
                number = vocabulary.number_of(point.namespace)
                body, joint, known = point.identifier, number or 0, number is not None
            if known and not 0 <= body <= LARGEST_BODY:
                msg = (
                    f'{recording.path}: a marker of {topic} has the number {point.identifier}, '
                    f'which is body {body}; bodies have numbers from 0 to {LARGEST_BODY}: name '
                    'the vocabulary of these markers with --joints'
                )
                raise InputError(msg)
            if known:
                yield JointSample(point.stamp, point.frame_id, body, joint, point.position)
    if lists and not single:
        msg = (
            f'{recording.path}: the markers of {topic} are lists of points, which do not say '
            'which joint is which; pose_node publishes skeletons, too: take --from skeletons'
        )
        raise InputError(msg)


def skeleton_samples(
    recording: RecordingReader, topic: str, vocabulary: Vocabulary, minimum_confidence: float
) -> Iterator[JointSample]:
    """Yield the joints in a topic of type sensor_msgs/PointCloud2, as the node publishes them.

    Args:
        recording: the recording.
        topic: its name; '' if the recording has only one.
        vocabulary: that of our own joints, or one with the numbers of the points.
        minimum_confidence: joints with less are left out.

    Raises:
        InputError: there is no such topic, it is ambiguous, or it has no skeletons.
    """
    topic = find_topic(recording, topic, POINT_CLOUD)
    for stamp, frame_id, skeletons in _messages(
        recording, topic, POINT_CLOUD, parse_framed_skeletons
    ):
        sure = skeletons.confidence >= minimum_confidence
        for row, column in np.argwhere(sure & np.isfinite(skeletons.positions).all(axis=-1)):
            joint = int(skeletons.joints[column])
            if joint < len(vocabulary.names):
                body = int(skeletons.bodies[row])
                position = skeletons.positions[row, column]
                yield JointSample(stamp, frame_id, body, joint, position)


def find_topic(recording: RecordingReader, wanted: str, type_name: str) -> str:
    """Return the topic `wanted`, or the only one of the type `type_name` if it is ''.

    Raises:
        InputError: there is no such topic, or it is ambiguous.
    """
    topics = _topics(recording, type_name)
    if wanted in topics:
        return wanted
    if not wanted and len(topics) == 1:
        return topics[0]
    problem = f'there is no topic {wanted}' if wanted else 'several topics could have the joints'
    if not topics:
        problem = 'no topic'
    msg = (
        f'{recording.path}: {problem} of the type {type_name}'
        f'{"; choose with --topic among " + ", ".join(topics) if topics else " was recorded"}'
    )
    raise InputError(msg)


def _topics(recording: RecordingReader, type_name: str) -> list[str]:
    return sorted(
        name
        for name, topic in recording.topics.items()
        if topic.type_name == type_name and topic.count != 0
    )


def _messages(
    recording: RecordingReader, topic: str, type_name: str, parse: Callable[[Any], _Values]
) -> Iterator[_Values]:
    for message in recording.select({topic}):
        try:
            values = read_as(message.data, type_name, parse)
        except DamagedMessageError:  # the reader of the frames counts those
            continue
        except InputError as error:
            msg = f'{recording.path}: topic {topic}: {error}'
            raise InputError(msg) from error
        yield values
