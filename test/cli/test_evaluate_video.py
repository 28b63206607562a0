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

"""`lsc_pose evaluate --video`: frames alone and over time, each estimated once."""

import json
from pathlib import Path

import pytest

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.evaluation.evaluate import evaluate, summarise
from lsc_pose_ros.evaluation.video_scores import VideoFrame, score_video
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

FRAMES = 24


@pytest.fixture(scope='module')
def video(easy: SyntheticSettings) -> list[Frame]:
    """Two clips with a person each."""
    settings = easy._replace(frames=FRAMES, seed=9, clip_length=FRAMES // 2, rate=30.0)
    return list(synthetic_frames(settings))


def test_each_frame_is_estimated_once_alone_and_once_over_time(
    video: list[Frame],
    small_model_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    estimator, path = Estimator(load_model(small_model_file)), tmp_path / 'v.mcap'
    with RecordingWriter(path) as writer:
        for frame in video:
            writer.write_frame(frame)
    calls, largest = [], Estimator.estimate_largest

    def counted(self, *arguments):
        calls.append(arguments[4] if len(arguments) > 4 else None)
        return largest(self, *arguments)

    monkeypatch.setattr(Estimator, 'estimate_largest', counted)
    output = tmp_path / 'results.json'
    words = ['evaluate', str(small_model_file), str(path), '--video', '--json', str(output)]
    assert main(words) == 0
    monkeypatch.undo()
    assert len(calls) == 2 * FRAMES
    assert sum(memory is not None for memory in calls) == FRAMES
    results = json.loads(output.read_text())
    alone = results['video']['frame by frame']
    frames = [
        VideoFrame(
            frame.stamp,
            estimator.estimate(frame.depth, frame.labels, frame.camera),
            frame.ground_truth,
        )
        for frame in video
    ]
    assert alone == pytest.approx(score_video(frames, 0.1)._asdict(), nan_ok=True)
    assert results['map'] == pytest.approx(summarise(evaluate(estimator, video), 0.1).map)
    # The cut between the clips changes no number.
    for way in results['video'].values():
        assert way['id_switches_per_minute'] == 0
    assert 'number changes a minute' in capsys.readouterr().out
