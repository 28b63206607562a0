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

"""What is wrong with the stream of frames, told from counters; no ROS in here."""

from collections.abc import Mapping
from typing import NamedTuple

# A few frames are left out on any computer that has something else to do now and then.
TOLERATED_SHARE = 0.05


class TopicNames(NamedTuple):
    """The full names of the topics that are listened to, for the sentences in the log.

    `mask` is empty where no mask is needed.
    """

    depth: str
    camera_info: str
    mask: str = ''

    @property
    def listened(self) -> tuple[str, ...]:
        """Those that are listened to."""
        return tuple(filter(None, self))


class Counters(NamedTuple):
    """How much has come and gone since the node was activated.

    Attributes:
        depth: depth images that came.
        masks: masks that came.
        camera_infos: camera infos that came.
        pairs: depth images that found their mask, or need none.
        replaced: pairs that gave way to a newer one before they were worked on.
        lost: images that the middleware knows to have lost.
        rewinds: how often the depth images' stamps went back.
        missing: depth images that never came, by the gaps between the stamps.
        unmatched_depth: depth images for which no mask came; ordinary where masks are slower.
        unmatched_masks: masks for which no depth image came.
        duplicates: images left out because their stamp had been there already.
        late: images left out because they came after a newer pair had been delivered.
        out_of_order: images that came after a newer one of their kind; some of them are late.
    """

    depth: int = 0
    masks: int = 0
    camera_infos: int = 0
    pairs: int = 0
    replaced: int = 0
    lost: int = 0
    rewinds: int = 0
    missing: int = 0
    unmatched_depth: int = 0
    unmatched_masks: int = 0
    duplicates: int = 0
    late: int = 0
    out_of_order: int = 0


class Situation(NamedTuple):
    """What is known besides the counters.

    Attributes:
        topics: what the node listens to.
        publishers: how many publishers each topic has.
        profile: the path of the Fast DDS profile.
        seconds: the time between the two readings.
    """

    topics: TopicNames
    publishers: Mapping[str, int]
    profile: str
    seconds: float = 5.0


def complaints(before: Counters, now: Counters, situation: Situation) -> dict[str, str]:
    """Return what has gone wrong between two readings of the counters.

    Returns:
        a sentence with the remedy for each kind of trouble; a kind keeps its name while it lasts.
    """
    gained = Counters(*(new - old for new, old in zip(now, before, strict=True)))
    topics = situation.topics
    found = {
        'no depth': _silence(topics.depth, gained.depth, _DEPTH_REMEDY, situation),
        'no mask': _silence(topics.mask, gained.masks, _MASK_REMEDY, situation),
        'no camera info': _no_camera_info(now, situation),
        'no pairs': _no_pairs(gained, topics),
        'loss': _loss(gained, situation),
        'rewind': _rewind(gained, topics),
        'disorder': _disorder(gained, topics),
        'overload': _overload(gained),
    }
    return {kind: text for kind, text in found.items() if text}


_DEPTH_REMEDY = 'start the camera, or remap depth/image to its topic'
_MASK_REMEDY = (
    'start the segmentation, remap mask to its topic, or set the parameter segmentation to '
    'nearest or background to do without'
)


def _silence(topic: str, came: int, remedy: str, situation: Situation) -> str:
    if came or not topic:
        return ''
    count = situation.publishers.get(topic, 0)
    if count:
        remedy = 'a publisher is there but sends nothing that arrives: look at its log'
    return (
        f'nothing received on {topic} for {situation.seconds:.0f} s '
        f'({_publishers(count)}); {remedy}'
    )


def _no_camera_info(now: Counters, situation: Situation) -> str:
    """Tell that there has never been one; one is enough."""
    if now.camera_infos:
        return ''
    topic = situation.topics.camera_info
    return (
        f'no camera info received on {topic} ({_publishers(situation.publishers.get(topic, 0))}), '
        'without which no depth image can be answered; let the camera driver publish it, or '
        "remap depth/camera_info to the depth camera's"
    )


def _publishers(count: int) -> str:
    return f'{count or "no"} publisher{"" if count == 1 else "s"}'


def _no_pairs(gained: Counters, topics: TopicNames) -> str:
    if gained.pairs or not (gained.depth and gained.masks):
        return ''
    return (
        f'no mask of {topics.mask} has the stamp of an image of {topics.depth}; publish masks '
        'with the stamp of their depth image, or set the parameters sync_slop and sync_queue'
    )


def _loss(gained: Counters, situation: Situation) -> str:
    """Tell of images that were sent and did not come."""
    came = gained.depth + gained.masks
    told = []
    if gained.missing > TOLERATED_SHARE * (gained.depth + gained.missing):
        told.append(
            f'by the stamps of {situation.topics.depth}, {gained.missing} of '
            f'{gained.depth + gained.missing} depth images are missing'
        )
    if gained.lost > TOLERATED_SHARE * (came + gained.lost):
        told.append(f'the middleware lost {gained.lost} images, with {came} received')
    if not told:
        return ''
    return (
        f'{", and ".join(told)}; start their publishers with '
        f'FASTRTPS_DEFAULT_PROFILES_FILE={situation.profile}, or let them publish reliably'
    )


def _rewind(gained: Counters, topics: TopicNames) -> str:
    if not gained.rewinds:
        return ''
    return (
        f'the stamps of {topics.depth} went back, so pairing began anew: a recording was played '
        'again, or two publishers share the topic'
    )


def _disorder(gained: Counters, topics: TopicNames) -> str:
    came = gained.depth + gained.masks
    wrong = gained.duplicates + gained.late
    if wrong <= TOLERATED_SHARE * came:
        return ''
    names = ' and '.join(filter(None, (topics.depth, topics.mask)))
    return (
        f'of {came} images on {names}, {gained.duplicates} repeat the stamp of another and '
        f'{gained.late} came after newer ones; let one publisher send each topic, with stamps '
        'that increase'
    )


def _overload(gained: Counters) -> str:
    if gained.replaced <= TOLERATED_SHARE * gained.pairs:
        return ''
    return (
        f'{gained.replaced} of {gained.pairs} frames were left out because newer ones came '
        'before they were worked on: they come faster than they can be estimated'
    )
