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

"""Finds the topics of depth image, camera info, mask and ground truth in a recording."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from lsc_pose_ros.bags.storage.serialized_messages import TopicSummary
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.image_encodings import DEPTH_TYPES
from lsc_pose_ros.messages.type_names import CAMERA_INFO, COMPRESSED_IMAGE, IMAGE, POINT_CLOUD
from lsc_pose_ros.settings.table import BACKGROUND, COMPRESSED_DEPTH, PEOPLE, RAW

_IMAGES = (IMAGE, COMPRESSED_IMAGE)
_MASK_WORDS = ('mask', 'body_index', 'label', 'segment')
_GROUND_TRUTH_WORDS = ('ground_truth', 'truth')


class Topics(NamedTuple):
    """The topics of a frame's messages; '' for one that is found by type and name."""

    depth: str = ''
    camera_info: str = ''
    mask: str = ''
    ground_truth: str = ''


DEFAULT_TOPICS = Topics('/depth/image', '/depth/camera_info', '/mask', '/ground_truth/skeletons')


class RecordedTopics(NamedTuple):
    """The topics of a recording.

    Attributes:
        path: the path of the recording, for error messages.
        topics: the topics by name.
        encodings: returns the encoding of the first image of each given topic. It is called only
            if the names are ambiguous, because it reads the recording.
    """

    path: str
    topics: Mapping[str, TopicSummary]
    encodings: Callable[[Sequence[str]], Mapping[str, str]]


class Transports(NamedTuple):
    """The transports of depth images and masks, which image_transport appends to their topics.

    RAW takes what was recorded, the raw images if there are several.
    """

    depth: str = RAW
    mask: str = RAW


_ANY_TRANSPORT = Transports()


def find_topics(
    given: Topics,
    recorded: RecordedTopics,
    transports: Transports = _ANY_TRANSPORT,
    *,
    with_masks: bool = True,
    need_mask: bool = True,
) -> Topics:
    """Return the topics of the frames; `mask` and `ground_truth` are '' if there are none.

    Args:
        given: the names that the user has given; each '' is searched for.
        recorded: the topics of the recording.
        transports: the transports of the images.
        with_masks: whether masks are searched for.
        need_mask: True to raise an error if there is no mask.

    Raises:
        InputError: a topic is missing, has another type, or is ambiguous.
    """
    given = given._replace(
        depth=_with_transport(given.depth, transports.depth),
        mask=_with_transport(given.mask, transports.mask),
    )
    depth = _named(given.depth, _IMAGES, recorded, 'depth')
    if not depth:
        found = _with_transport(_find_depth(recorded), transports.depth)
        depth = _named(found, _IMAGES, recorded, 'depth')
    info = _named(given.camera_info, (CAMERA_INFO,), recorded, 'camera-info')
    mask = _find_mask(given.mask, recorded, depth, transports.mask) if with_masks else ''
    ground_truth = _named(given.ground_truth, (POINT_CLOUD,), recorded, 'ground-truth')
    if with_masks and need_mask and not mask:
        raise InputError(_no_mask(recorded, depth))
    return Topics(
        depth,
        info or _find_camera_info(recorded, depth),
        mask,
        ground_truth or _find_ground_truth(recorded),
    )


def _with_transport(topic: str, transport: str) -> str:
    """Return the topic of the images of `topic` in a transport; '' stays ''."""
    if not topic or transport == RAW or topic.endswith(f'/{transport}'):
        return topic
    return f'{topic}/{transport}'


def _no_mask(recorded: RecordedTopics, depth: str, given: str = '') -> str:
    """Return that no mask was found, or not the `given` one, and what to do."""
    base = depth.removesuffix(f'/{COMPRESSED_DEPTH}')
    others = [
        name for name in _of_types(recorded, _IMAGES) if name != base and base != _parent(name)
    ]
    choice = f'name its topic with --mask-topic ({", ".join(others)}), or ' if others else ''
    return (
        f'{recorded.path}: {f"no topic {given}" if given else "no mask topic"} was recorded; '
        f'{choice}'
        f'find the people without one: --segmentation {PEOPLE} or {BACKGROUND}'
    )


def _parent(topic: str) -> str:
    return topic.rpartition('/')[0]


def _named(name: str, types: Sequence[str], recorded: RecordedTopics, option: str) -> str:
    """Return `name` if it is a topic with one of `types`, '' if it is ''."""
    if not name:
        return ''
    topic = recorded.topics.get(name)
    if topic is None:
        msg = f'{recorded.path}: no topic {name}; {_advice(recorded, types, option)}'
        raise InputError(msg)
    if topic.type_name not in types:
        msg = (
            f'{recorded.path}: the topic {name} is a {topic.type_name}; '
            f'{_advice(recorded, types, option)}'
        )
        raise InputError(msg)
    return name


def _find_depth(recorded: RecordedTopics) -> str:
    images = [
        name for name in _of_types(recorded, _IMAGES) if not _contains_any(name, _MASK_WORDS)
    ]
    if DEFAULT_TOPICS.depth in images:
        return DEFAULT_TOPICS.depth
    named = _without_transports([name for name in images if 'depth' in name.lower()])
    if len(named) == 1:
        return named[0]
    encodings = recorded.encodings(named or images)
    found = [name for name in named or images if _is_depth(encodings.get(name, ''))]
    if not found and not named:
        msg = f'{recorded.path}: no depth topic; {_advice(recorded, _IMAGES, "depth")}'
        raise InputError(msg)
    return _only(found or named, recorded, 'depth')


def _find_camera_info(recorded: RecordedTopics, depth: str) -> str:
    infos = _of_types(recorded, (CAMERA_INFO,))
    if not infos:
        msg = f'{recorded.path}: no camera info (sensor_msgs/msg/CameraInfo) was recorded'
        raise InputError(msg)
    # The convention: camera_info is a sibling of the image; a transport is a child of the image.
    parents = (depth.rpartition('/')[0], depth.rpartition('/')[0].rpartition('/')[0])
    for parent in parents:
        if f'{parent}/camera_info' in infos:
            return f'{parent}/camera_info'
    if len(infos) == 1:
        return infos[0]
    named = [name for name in infos if 'depth' in name.lower()]
    return _only(named or infos, recorded, 'camera-info')


def _find_mask(given: str, recorded: RecordedTopics, depth: str, transport: str) -> str:
    """Return the topic of the masks: `given`, or the one that is found; '' for none."""
    if given and given not in recorded.topics:
        raise InputError(_no_mask(recorded, depth, given))
    named = _named(given, _IMAGES, recorded, 'mask')
    if named:
        return named
    found = _with_transport(_search_mask(recorded, depth), transport)
    return _named(found, _IMAGES, recorded, 'mask')


def _search_mask(recorded: RecordedTopics, depth: str) -> str:
    images = [name for name in _of_types(recorded, _IMAGES) if name != depth]
    if DEFAULT_TOPICS.mask in images:
        return DEFAULT_TOPICS.mask
    found = _without_transports([name for name in images if _contains_any(name, _MASK_WORDS)])
    return _only(found, recorded, 'mask') if found else ''


def _find_ground_truth(recorded: RecordedTopics) -> str:
    clouds = _of_types(recorded, (POINT_CLOUD,))
    if DEFAULT_TOPICS.ground_truth in clouds:
        return DEFAULT_TOPICS.ground_truth
    found = [name for name in clouds if _contains_any(name, _GROUND_TRUTH_WORDS)]
    return _only(found, recorded, 'ground-truth') if found else ''


def _of_types(recorded: RecordedTopics, types: Sequence[str]) -> list[str]:
    """Return the topics of `types` that have messages, sorted by name."""
    return sorted(
        name
        for name, topic in recorded.topics.items()
        if topic.type_name in types and topic.count != 0
    )


def _without_transports(names: list[str]) -> list[str]:
    """Remove the topics of image_transport whose raw image is among `names`."""
    return [name for name in names if _parent(name) not in names]


def _contains_any(name: str, words: Sequence[str]) -> bool:
    return any(word in name.lower() for word in words)


def _is_depth(encoding: str) -> bool:
    return encoding in DEPTH_TYPES or 'compressedDepth' in encoding


def _only(names: list[str], recorded: RecordedTopics, option: str) -> str:
    if len(names) > 1:
        msg = (
            f'{recorded.path}: several topics could be the {option.replace("-", " ")}: '
            f'{", ".join(names)}; choose with --{option}-topic'
        )
        raise InputError(msg)
    return names[0]


def _advice(recorded: RecordedTopics, types: Sequence[str], option: str) -> str:
    candidates = _of_types(recorded, types)
    if not candidates:
        return f'the recording has no messages of the type {" or ".join(types)}'
    return f'choose with --{option}-topic among {", ".join(candidates)}'
