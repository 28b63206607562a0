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

"""Reads estimated skeletons from a recording, as a node or a replay has published them."""

from collections.abc import Collection

from lsc_pose_ros.bags import RecordingReader, TopicSummary
from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.deserialize import DamagedMessageError, read_skeletons
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.type_names import POINT_CLOUD


def find_skeletons_topic(recording: RecordingReader, wanted: str, ground_truth: str) -> str:
    """Return the topic with estimated skeletons, '' if there is none.

    Args:
        recording: the recording.
        wanted: the topic from the command line; '' to find it by type and name.
        ground_truth: the topic of the ground truth, which is excluded.

    Raises:
        InputError: `wanted` has no skeletons, or several topics have skeletons.
    """
    clouds = [name for name, topic in recording.topics.items() if _has_clouds(topic)]
    if wanted:
        if wanted not in clouds:
            msg = (
                f'{recording.path}: {wanted} has no skeletons; '
                f'its PointCloud2 topics: {", ".join(sorted(clouds)) or "none"}'
            )
            raise InputError(msg)
        return wanted
    found = sorted(name for name in clouds if name.endswith('/skeletons') and name != ground_truth)
    if SKELETONS_TOPIC in found:
        return SKELETONS_TOPIC
    if len(found) > 1:
        msg = (
            f'{recording.path}: several topics have skeletons: {", ".join(found)}; '
            'choose one with --skeletons-topic'
        )
        raise InputError(msg)
    return found[0] if found else ''


def read_skeletons_at(
    recording: RecordingReader, topic: str, stamps: Collection[int]
) -> dict[int, Skeletons]:
    """Return the skeletons of `topic` that have one of `stamps` (nanoseconds), by stamp."""
    found: dict[int, Skeletons] = {}
    wanted = set(stamps)
    for message in recording:
        if message.topic != topic:
            continue
        try:
            stamp, skeletons = read_skeletons(message.data)
        except DamagedMessageError:
            continue  # the reader of the frames has already warned
        except InputError as error:
            msg = f'{recording.path}: topic {topic}: {error}'
            raise InputError(msg) from error
        if stamp in wanted:
            found[stamp] = skeletons
        if len(found) == len(wanted):
            break
    return found


def stamps_with_joints(recording: RecordingReader, topic: str) -> set[int]:
    """Return the stamps (nanoseconds) at which the skeletons of `topic` have a known joint."""
    stamps = set()
    for message in recording.select({topic}):
        try:
            stamp, skeletons = read_skeletons(message.data)
        except (DamagedMessageError, InputError):
            continue  # what cannot be read is told when the frames are drawn
        if known_bodies(skeletons):
            stamps.add(stamp)
    return stamps


def _has_clouds(topic: TopicSummary) -> bool:
    return topic.type_name == POINT_CLOUD and topic.count != 0
