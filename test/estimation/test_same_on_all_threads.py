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

"""The same answers and the same model, bit for bit, on one thread and on two."""

import os
import subprocess
import sys

import pytest

# Trains twice as many trees as there are threads, so that both have work, and estimates by them.
_PROGRAM = """
import hashlib, sys
import numba
from lsc_pose_ros import Estimator
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.model_io.model_file import save_model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.training.train import TrainingSettings, train

frames = list(synthetic_frames(SyntheticSettings(frames=60, width=160, height=120, seed=4)))
settings = Settings(points=400, query_points=100, body_yaws=8)
model = train(frames, TrainingSettings(numbers_of(DEFAULT_JOINTS), settings, trees=2), {})
save_model(sys.argv[1], model)
digest = hashlib.sha256(open(sys.argv[1], 'rb').read())
print('model', digest.hexdigest())
estimator = Estimator(model)
answers = hashlib.sha256()
for frame in frames:
    skeletons = estimator.estimate(frame.depth, frame.labels, frame.camera)
    answers.update(skeletons.positions.tobytes() + skeletons.confidence.tobytes())
print('answers', answers.hexdigest())
print('threads', numba.config.NUMBA_NUM_THREADS, file=sys.stderr)
"""


def run(threads, path):
    environment = os.environ | {'NUMBA_NUM_THREADS': str(threads)}
    ended = subprocess.run(
        [sys.executable, '-c', _PROGRAM, str(path)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert f'threads {threads}' in ended.stderr
    return ended.stdout


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason='this computer has one core')
def test_one_thread_and_two_give_the_same_bits(tmp_path):
    one, two = (run(threads, tmp_path / 'me.npz') for threads in (1, 2))
    assert one == two
    assert one.count('\n') == 2
