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

"""Programs that run with a fresh installation instead of the sources that are tested."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from waiting import COMPILING_PATIENCE

# Variables that would change what a new interpreter, pip or colcon finds.
_REMOVED = ('AMENT_', 'COLCON_', 'NUMBA_', 'PIP_', 'PYTHON', '_ROS_WHEELS')

CHECK = """
import json

import numpy as np
import yaml

import lsc_pose_ros
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.resources.package_files import find_model, resource

model = load_model(find_model())
body = np.load(resource('bodies', 'body.npz'))
parameters = yaml.safe_load(resource('config', 'pose_node.yaml').read_text())
print(json.dumps({
    'package': lsc_pose_ros.__file__,
    'joints': len(model.joints),
    'body': len(body['mean']),
    'parameters': list(parameters),
}))
"""

ESTIMATE = """
import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model

depth, labels = np.full((60, 80), 4, np.float32), np.full((60, 80), -1, np.int32)
depth[8:52, 30:50], labels[8:52, 30:50] = 2, 1
estimator = Estimator(load_model(find_model()))
positions = estimator.estimate(depth, labels, Intrinsics(70.0, 70.0, 40.0, 30.0)).positions
print(positions.shape, bool(np.isfinite(positions).all()))
"""


def clean_environment(**variables: str) -> dict[str, str]:
    """Return this process's environment without what points to its own packages."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith(_REMOVED)}
    return {**kept, **variables}


def run(*words: object, cwd: Path, **variables: str) -> str:
    """Run a program, which must succeed, and return its standard output."""
    done = subprocess.run(
        [str(word) for word in words],
        cwd=cwd,
        env=clean_environment(**variables),
        check=False,
        capture_output=True,
        text=True,
        timeout=COMPILING_PATIENCE,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def check_installation(*words: object, cwd: Path, **variables: str) -> dict[str, Any]:
    """Return what `CHECK` finds with the interpreter that the command `words` starts."""
    report: dict[str, Any] = json.loads(run(*words, '-c', CHECK, cwd=cwd, **variables))
    return report
