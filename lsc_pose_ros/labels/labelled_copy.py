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

"""Writes a copy of a recording with labels."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from lsc_pose_ros.bags import DEFAULT_TOPICS, FrameReader, RecordingReader, RecordingWriter
from lsc_pose_ros.bags.message_copier import MessageCopier
from lsc_pose_ros.bags.serialization.serialize import skeletons_message
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.labels.body_matching import numbered_as_mask
from lsc_pose_ros.labels.tracks import LabelSource
from lsc_pose_ros.messages.type_names import POINT_CLOUD, TF_MESSAGE


@dataclass
class LabelCounts:
    """What a labelled copy contains.

    Attributes:
        frames: all frames.
        labelled: those with a labelled body, of which a joint is known.
        bodies: the labelled bodies of all frames.
        behind: joints that were left out because they are not in front of the camera.
        unmatched: bodies that were left out because no mask shows them.
        missing: the frames that are not labelled, by the reason, in words that follow 'N frames'.
    """

    frames: int = 0
    labelled: int = 0
    bodies: int = 0
    behind: int = 0
    unmatched: int = 0
    missing: Counter[str] = field(default_factory=Counter)


def write_labelled_copy(
    frames: FrameReader,
    source: LabelSource,
    writer: RecordingWriter,
    counts: LabelCounts,
    clean: Callable[[Frame, Skeletons], Skeletons] | None = None,
) -> Iterator[Frame]:
    """Copy the messages of the frames, and add the labels of each frame.

    The labels have the stamp, the frame and the log time of their depth image. Labels that the
    recording had on the same topic are replaced.

    Args:
        frames: the frames, not turned upright.
        source: knows the labels.
        writer: writes the copy.
        counts: is kept up to date.
        clean: returns the labels that are kept.

    Yields:
        Each frame with its labels, after they are written.
    """
    topic = frames.topics.ground_truth or DEFAULT_TOPICS.ground_truth
    copied = frozenset(filter(None, frames.topics)) | _transform_topics(frames)
    copier = MessageCopier(frames, writer, copied - {topic})
    for number, frame in enumerate(frames):
        log_time = copier.copy_up_to(frame.stamp)
        skeletons = source.at(number, frame)
        reason = '' if known_bodies(skeletons) else source.why_none(number, frame)
        skeletons, behind = in_front(skeletons)
        counts.behind += behind
        reason = reason or (
            '' if known_bodies(skeletons) else 'whose joints are behind the camera'
        )
        if frames.topics.mask:
            matched = numbered_as_mask(skeletons, frame)
            counts.unmatched += len(skeletons.bodies) - len(matched.bodies)
            skeletons = matched
            reason = reason or ('' if known_bodies(skeletons) else 'whose bodies no mask shows')
        if clean is not None:
            skeletons = clean(frame, skeletons)
            reason = reason or ('' if known_bodies(skeletons) else 'whose joints were all dropped')
        if reason:
            counts.missing[reason] += 1
        counts.frames += 1
        counts.labelled += known_bodies(skeletons) > 0
        counts.bodies += known_bodies(skeletons)
        data = skeletons_message(frame.stamp, frame.frame_id, skeletons)
        writer.write(topic, POINT_CLOUD, log_time, data)
        yield frame._replace(ground_truth=skeletons)
    copier.copy_rest()


def in_front(skeletons: Skeletons) -> tuple[Skeletons, int]:
    """Return the joints that a camera can see, the others unknown, and how many these others are.

    Args:
        skeletons: in the optical frame, whose z points away from the camera.
    """
    behind = skeletons.positions[..., 2] <= 0
    if not behind.any():
        return skeletons, 0
    kept = skeletons._replace(
        positions=np.where(behind[..., None], np.float32(np.nan), skeletons.positions),
        confidence=np.where(behind, np.float32(0), skeletons.confidence),
    )
    return kept, int(behind.sum())


def _transform_topics(frames: FrameReader) -> frozenset[str]:
    topics = RecordingReader(frames.path).topics
    return frozenset(name for name, each in topics.items() if each.type_name == TF_MESSAGE)
