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

"""An estimated copy has all that a program without ROS, such as Foxglove, needs to show it."""

import json
from collections import deque
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tiny_model import tiny_model

from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.bags.estimated_copy import MARKERS_TOPIC, SKELETONS_TOPIC, write_estimated_copy
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.settings.table import TemporalSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

FRAMES = 3


@pytest.fixture(scope='module')
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('copy')
    settings = SyntheticSettings(frames=FRAMES, width=160, height=120, distance=(2.0, 3.0))
    with RecordingWriter(folder / 'people.mcap') as writer:
        for frame in synthetic_frames(settings):
            writer.write_frame(frame)
    shown = TemporalSettings(minimum_body_confidence=0.0, minimum_stature=0.0)
    estimator = TemporalEstimator(Estimator(tiny_model()), shown)
    with RecordingWriter(folder / 'estimated.mcap') as writer:
        frames = open_recording(folder / 'people.mcap')
        deque(write_estimated_copy(frames, estimator, writer), maxlen=0)
    return folder / 'estimated.mcap'


@pytest.fixture(scope='module')
def messages(copy: Path) -> dict[str, list[Any]]:
    """The messages by topic, read with nothing but the definitions in the file."""
    found: dict[str, list[Any]] = {}
    with copy.open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == 'ros2'
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ('ros2msg', 'cdr')
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg(schema.data.decode(), schema.name))
            decoded = store.deserialize_cdr(message.data, schema.name)
            found.setdefault(channel.topic, []).append(decoded)
    return found


def test_every_message_is_readable_with_the_definitions_in_the_file(
    messages: dict[str, list[Any]],
) -> None:
    assert {'/depth/image', '/depth/camera_info', '/mask', SKELETONS_TOPIC, MARKERS_TOPIC} <= set(
        messages
    )
    assert all(len(each) == FRAMES for each in messages.values())


def test_markers_are_visible_in_the_frame_of_the_camera(messages: dict[str, list[Any]]) -> None:
    images = messages['/depth/image']
    for image, array in zip(images, messages[MARKERS_TOPIC], strict=True):
        drawn = [marker for marker in array.markers if marker.action == marker.ADD]
        assert drawn
        for marker in drawn:
            assert str(marker.header) == str(image.header)
            assert marker.scale.x > 0
            assert marker.color.a > 0 or all(colour.a > 0 for colour in marker.colors)
        assert len({(marker.ns, marker.id) for marker in drawn}) == len(drawn)


def test_layout_of_the_package_shows_the_topics_in_the_file(
    messages: dict[str, list[Any]],
) -> None:
    layout = json.loads(resource('config', 'foxglove_layout.json').read_text(encoding='utf-8'))
    shown = layout['configById']['3D!skeletons']
    assert {topic for topic, each in shown['topics'].items() if each['visible']} <= set(messages)
    assert shown['followTf'] == messages['/depth/image'][0].header.frame_id
