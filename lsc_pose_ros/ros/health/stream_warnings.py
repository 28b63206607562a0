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

"""Finds out from counters what is wrong with the stream of frames; does not import ROS."""

from collections.abc import Mapping
from enum import Enum, auto
from typing import NamedTuple

TOLERATED_FRACTION = 0.05
"""Any computer that also does other work leaves out a few frames."""

_MINUTE = 60.0


class TopicNames(NamedTuple):
    """The full names of the subscribed topics, for the messages in the log.

    `mask` is empty if no mask is needed.
    """

    depth: str
    camera_info: str
    mask: str = ''

    @property
    def subscribed(self) -> tuple[str, ...]:
        """The names of the topics that are subscribed."""
        return tuple(filter(None, self))


class Delivery(Enum):
    """How the messages of a topic are delivered."""

    BEST_EFFORT = auto()
    """A publisher offers only best effort."""
    RELIABLE_UNUSED = auto()
    """All publishers offer reliable delivery, but the node subscribes with best effort."""
    RELIABLE = auto()
    """Reliably."""


class Counters(NamedTuple):
    """How many messages and events there were since the node was activated.

    Attributes:
        depth: received depth images.
        masks: received masks.
        camera_infos: received camera infos.
        pairs: depth images that found their mask, or need none.
        replaced: pairs that were replaced by a newer one before the worker took them.
        lost: images that the middleware reports as lost.
        lost_camera_infos: camera infos that the middleware reports as lost.
        rewinds: how often the stamps of the depth images went back.
        missing: depth images that were never received, according to the gaps between stamps.
        unmatched_depth: depth images without a mask; normal if masks are slower.
        unmatched_masks: masks without a depth image.
        duplicates: images left out because an earlier one has the same stamp.
        late: images left out because a newer pair had already been delivered.
        out_of_order: images received after a newer one of their kind; some of them are late.
    """

    depth: int = 0
    masks: int = 0
    camera_infos: int = 0
    pairs: int = 0
    replaced: int = 0
    lost: int = 0
    lost_camera_infos: int = 0
    rewinds: int = 0
    missing: int = 0
    unmatched_depth: int = 0
    unmatched_masks: int = 0
    duplicates: int = 0
    late: int = 0
    out_of_order: int = 0

    def since(self, before: 'Counters') -> 'Counters':
        """Return by how much each counter has increased."""
        return Counters(*(now - old for now, old in zip(self, before, strict=True)))


class StreamContext(NamedTuple):
    """What the warnings name besides the counters.

    Attributes:
        topics: the subscribed topics.
        publishers: how many publishers each topic has.
        profile: the path of the Fast DDS profile.
        silence: for how long nothing has been received on each topic, seconds.
        delivery: how the messages of each topic are delivered.
    """

    topics: TopicNames
    publishers: Mapping[str, int]
    profile: str
    silence: Mapping[str, float]
    delivery: Mapping[str, Delivery]


def stream_warnings(before: Counters, now: Counters, context: StreamContext) -> dict[str, str]:
    """Return what went wrong between two readings of the counters.

    Returns:
        A sentence with the remedy for each kind of problem. The name of a kind stays the same
        while the problem lasts.
    """
    increase = now.since(before)
    topics = context.topics
    found = {
        'no depth': _nothing_received(topics.depth, increase.depth, _DEPTH_REMEDY, context),
        'no mask': _nothing_received(topics.mask, increase.masks, _MASK_REMEDY, context),
        'no camera info': _no_camera_info(now, context),
        'no pairs': _no_pairs(increase, topics),
        'loss': _loss(increase, context),
        'camera info loss': _camera_info_loss(increase, context),
        'rewind': _rewind(increase, topics),
        'disorder': _disorder(increase, topics),
        'overload': _overload(increase),
    }
    return {kind: text for kind, text in found.items() if text}


_DEPTH_REMEDY = 'start the camera, or remap depth/image to its topic'
_MASK_REMEDY = (
    'start the program that publishes masks, remap mask to its topic, or set the parameter '
    'segmentation to people or background, which need no mask'
)


def _nothing_received(topic: str, received: int, remedy: str, context: StreamContext) -> str:
    if received or not topic:
        return ''
    count = context.publishers.get(topic, 0)
    if count:
        remedy = 'there is a publisher, but none of its messages arrives: look at its log'
    silence = duration(context.silence[topic])
    return f'nothing received on {topic} for {silence} ({_publishers(count)}); {remedy}'


def _no_camera_info(now: Counters, context: StreamContext) -> str:
    """Return a warning if there has never been a camera info; one is enough."""
    if now.camera_infos:
        return ''
    topic = context.topics.camera_info
    return (
        f'no camera info received on {topic} ({_publishers(context.publishers.get(topic, 0))}); '
        'without it no depth image can be estimated; let the camera driver publish it, or '
        'remap depth/camera_info to the topic of the depth camera'
    )


def _publishers(count: int) -> str:
    return f'{count or "no"} publisher{"" if count == 1 else "s"}'


def _no_pairs(increase: Counters, topics: TopicNames) -> str:
    if increase.pairs or not (increase.depth and increase.masks):
        return ''
    if increase.duplicates >= increase.depth:
        return ''  # all stamps are equal, zero perhaps, which is another warning
    return (
        f'no mask of {topics.mask} has the stamp of an image of {topics.depth}; publish masks '
        'with the stamp of their depth image, or set the parameters sync_slop and sync_queue'
    )


def _loss(increase: Counters, context: StreamContext) -> str:
    """Return a warning if images were sent but not received."""
    received = increase.depth + increase.masks
    sent_depth = increase.depth + increase.missing
    topics = context.topics
    affected: list[str] = []
    reasons = []
    if increase.missing > TOLERATED_FRACTION * sent_depth:
        affected.append(topics.depth)
        reasons.append(
            f'according to the stamps of {topics.depth}, {increase.missing} of '
            f'{sent_depth} depth images are missing'
        )
    if increase.lost > TOLERATED_FRACTION * (received + increase.lost):
        affected += [topics.depth, topics.mask]
        reasons.append(f'the middleware lost {increase.lost} images and received {received}')
    if not reasons:
        return ''
    return f'{", and ".join(reasons)}; {_loss_remedy(affected, context)}'


def _camera_info_loss(increase: Counters, context: StreamContext) -> str:
    """Return a warning if camera infos were sent but not received."""
    lost, received = increase.lost_camera_infos, increase.camera_infos
    if lost <= TOLERATED_FRACTION * (received + lost):
        return ''
    topic = context.topics.camera_info
    return (
        f'the middleware lost {lost} camera infos of {topic} and received {received}; '
        f'{_loss_remedy([topic], context)}'
    )


def _loss_remedy(topics: list[str], context: StreamContext) -> str:
    """Return what helps against lost messages of some topics."""
    delivery = {
        context.delivery.get(topic, Delivery.BEST_EFFORT) for topic in filter(None, topics)
    }
    profile = f'FASTRTPS_DEFAULT_PROFILES_FILE={context.profile}'
    if Delivery.RELIABLE_UNUSED in delivery:
        return (
            'their publishers offer reliable delivery: set the parameter reliability to auto, or '
            f'start them with {profile}'
        )
    if Delivery.BEST_EFFORT in delivery:
        return f'start their publishers with {profile}, or let them publish reliably'
    return (
        'their publishers deliver reliably, so their queues are too short or they leave messages '
        f'out themselves: give them longer queues (QoS depth), or start them with {profile}'
    )


def duration(seconds: float) -> str:
    """Return a duration in seconds, or in minutes from two minutes on."""
    return f'{seconds:.0f} s' if seconds < 2 * _MINUTE else f'{seconds / _MINUTE:.0f} min'


def _rewind(increase: Counters, topics: TopicNames) -> str:
    if not increase.rewinds:
        return ''
    return (
        f'the stamps of {topics.depth} went back, so synchronization started again: a recording '
        'was played again, or two publishers share the topic'
    )


def _disorder(increase: Counters, topics: TopicNames) -> str:
    received = increase.depth + increase.masks
    left_out = increase.duplicates + increase.late
    if left_out <= TOLERATED_FRACTION * received:
        return ''
    names = ' and '.join(filter(None, (topics.depth, topics.mask)))
    return (
        f'of {received} images on {names}, {increase.duplicates} repeat the stamp of another and '
        f'{increase.late} came after newer ones; let one publisher send each topic, with '
        'increasing stamps'
    )


def _overload(increase: Counters) -> str:
    if increase.replaced <= TOLERATED_FRACTION * increase.pairs:
        return ''
    return (
        f'{increase.replaced} of {increase.pairs} frames were left out because newer ones '
        'replaced them: frames come faster than they can be estimated'
    )
