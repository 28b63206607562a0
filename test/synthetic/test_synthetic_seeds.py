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

"""Tests that a seed gives the same frames with each version of Python, numpy and numba."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import COMPILING_PATIENCE

import lsc_pose_ros

DIGEST = """
import hashlib, sys
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

digest = hashlib.sha256()
for settings in (
    SyntheticSettings(frames=40, clip_length=4, yaw=180.0),
    SyntheticSettings(frames=12, clip_length=6, people=3, rate=30.0, background=True,
                      distance=(2.0, 5.0)),
    SyntheticSettings(frames=40, clip_length=4, people=2, furniture=True, yaw=180.0,
                      distance=(1.0, 5.0)),
    SyntheticSettings(frames=12, clip_length=6, furniture=True, rate=30.0, sensor='realsense'),
    *(SyntheticSettings(frames=3, clip_length=3, sensor=name, distance=(3.0, 5.0),
                        background=background)
      for name in ('kinect_v2', 'azure', 'realsense', 'realsense_filtered', 'zed', 'tof')
      for background in (False, True)),
):
    for frame in synthetic_frames(settings):
        for array in (frame.depth, frame.labels, frame.ground_truth.positions):
            digest.update(array.tobytes())
print(sys.version_info[:2], digest.hexdigest())
"""


def other_pythons() -> list[str]:
    """Return other Pythons, in LSC_POSE_PYTHONS or on the path, that have the requirements."""
    named = os.environ.get('LSC_POSE_PYTHONS', '').split(os.pathsep)
    named += [shutil.which(f'python3.{minor}') or '' for minor in range(10, 14)]
    needed = 'import numba, numpy, yaml'
    return [
        python
        for python in dict.fromkeys(filter(None, named))
        if Path(python).resolve() != Path(sys.executable).resolve()
        and not subprocess.run([python, '-c', needed], check=False, capture_output=True).returncode
    ]


def digest_of(python: str) -> str:
    folder = str(Path(lsc_pose_ros.__file__).parents[1])
    done = subprocess.run(
        [python, '-c', DIGEST],
        env=os.environ | {'PYTHONPATH': folder},
        check=False,
        capture_output=True,
        text=True,
        timeout=COMPILING_PATIENCE,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()[-1]


def test_frames_are_the_same_with_every_python() -> None:
    others = other_pythons()
    if not others:
        pytest.skip('no other Python with numba and numpy; name some in LSC_POSE_PYTHONS')
    own = digest_of(sys.executable)
    assert {python: digest_of(python) for python in others} == dict.fromkeys(others, own)
