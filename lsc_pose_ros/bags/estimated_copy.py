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

"""Writes a copy of a recording with estimated skeletons, as a live node would publish them."""

from collections.abc import Iterator

from lsc_pose_ros.bags import FrameReader, RecordingWriter
from lsc_pose_ros.bags.message_copier import MessageCopier
from lsc_pose_ros.bags.serialization.serialize import markers_message, skeletons_message
from lsc_pose_ros.camera.roll import in_camera_frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.messages.markers import MarkerUpdater
from lsc_pose_ros.messages.type_names import MARKER_ARRAY, POINT_CLOUD
from lsc_pose_ros.settings.table import DrawingSettings

SKELETONS_TOPIC = '/pose_node/skeletons'
MARKERS_TOPIC = '/pose_node/joint_markers'

_DEFAULT_DRAWING = DrawingSettings()


def write_estimated_copy(
    frames: FrameReader,
    temporal_estimator: TemporalEstimator,
    writer: RecordingWriter,
    drawing_settings: DrawingSettings = _DEFAULT_DRAWING,
) -> Iterator[Skeletons]:
    """Copy the messages of the frames, and add the estimated skeletons and markers of each frame.

    An estimate has the header and the log time of its depth image.

    Args:
        frames: the frames.
        temporal_estimator: estimates the frames in their order.
        writer: writes the copy.
        drawing_settings: how the joints are drawn.

    Yields:
        Each estimate, after it is written.
    """
    topics = frozenset(filter(None, frames.topics)) | frames.transform_topics
    copier = MessageCopier(frames, writer, topics)
    marker_updater = MarkerUpdater(temporal_estimator.estimator.model.edges)
    for frame in frames:
        log_time = copier.copy_up_to(frame.stamp)
        skeletons = temporal_estimator.estimate(
            frame.stamp, frame.depth, frame.labels, frame.camera, from_mask=frame.from_mask
        )
        skeletons = in_camera_frame(skeletons, frame.roll)
        shapes = marker_updater.update(skeletons, drawing_settings)
        head = (frame.stamp, frame.frame_id)
        writer.write(SKELETONS_TOPIC, POINT_CLOUD, log_time, skeletons_message(*head, skeletons))
        writer.write(MARKERS_TOPIC, MARKER_ARRAY, log_time, markers_message(*head, shapes))
        yield skeletons
    copier.copy_rest()
