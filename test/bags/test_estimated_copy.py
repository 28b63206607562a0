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

"""A replay gives the estimates of the live node: both use one `TemporalEstimator`."""

from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC, write_estimated_copy
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import (
    NEAREST,
    TRACKED,
    FrameSettings,
    TemporalSettings,
)
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

ALL = TemporalSettings(smoothing=True, smoothing_beta=2.0, body_ids=TRACKED)


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two people, whose masks change numbers, and then one of them alone."""
    path = tmp_path_factory.mktemp('answering') / 'two.mcap'
    settings = SyntheticSettings(
        frames=16, seed=2, width=160, height=120, distance=(2.4, 3.0), people=2, rate=30.0
    )
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(synthetic_frames(settings)):
            labels = frame.labels
            if number % 5 == 2:
                labels = np.where(labels == NO_BODY, NO_BODY, 3 - labels).astype(np.int32)
            if number > 12:
                labels = np.where(labels == 2, 1, NO_BODY).astype(np.int32)
            writer.write_frame(frame._replace(labels=labels, ground_truth=None))
    return path


def live(frames: list[Frame], model: Model, settings: TemporalSettings) -> list[Skeletons]:
    """What a node's worker does, one frame after the other."""
    temporal_estimator = TemporalEstimator(Estimator(model), settings)
    return [
        temporal_estimator.estimate(each.stamp, each.depth, each.labels, each.camera)
        for each in frames
    ]


def assert_same(found: list[Skeletons], expected: list[Skeletons]) -> None:
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        for name in Skeletons._fields:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name), name)


def written(path: Path) -> list[Skeletons]:
    return [
        read_skeletons(message.data).skeletons
        for message in read_messages(path)
        if message.topic == SKELETONS_TOPIC
    ]


@pytest.mark.parametrize(
    'settings',
    [
        TemporalSettings(),
        TemporalSettings(body_ids=TRACKED),
        TemporalSettings(smoothing=True),
        ALL,
    ],
)
def test_replay_and_live_give_the_same_joints(
    recording: Path, small_model: Model, settings: TemporalSettings, tmp_path: Path
) -> None:
    output = tmp_path / 'out.mcap'
    with RecordingWriter(output) as writer:
        temporal_estimator = TemporalEstimator(Estimator(small_model), settings)
        answers = list(write_estimated_copy(open_recording(recording), temporal_estimator, writer))
    expected = live(list(open_recording(recording)), small_model, settings)
    assert_same(answers, expected)
    assert_same(written(output), expected)
    assert np.isfinite(answers[0].positions).any()


def test_settings_make_a_difference(recording: Path, small_model: Model) -> None:
    frames = list(open_recording(recording))
    plain, smooth = (live(frames, small_model, each) for each in (TemporalSettings(), ALL))
    assert not np.array_equal(plain[1].positions, smooth[1].positions, equal_nan=True)


def test_bodies_without_masks(recording: Path, small_model: Model, tmp_path: Path) -> None:
    frames = list(open_recording(recording))
    how = FrameSettings(segmentation=NEAREST, range_min=0.5, range_max=3.6)
    segmenter = make_segmenter(how)
    assert segmenter is not None
    expected = live(
        [
            each._replace(labels=segment(segmenter, each.stamp, each.depth, each.camera))
            for each in frames
        ],
        small_model,
        ALL,
    )
    with RecordingWriter(tmp_path / 'out.mcap') as writer:
        temporal_estimator = TemporalEstimator(Estimator(small_model), ALL)
        found = list(
            write_estimated_copy(
                open_recording(recording, settings=how), temporal_estimator, writer
            )
        )
    assert_same(found, expected)
    assert np.isfinite(found[0].positions).any()
