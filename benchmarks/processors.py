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

# ruff: noqa: INP001 - a program, not a package
"""How far answers on one processor differ from those on another one.

`python benchmarks/processors.py RECORDING` estimates the same frames by kernels that are compiled
for this processor, and by kernels for any processor of its family (NUMBA_CPU_NAME=generic): other
instructions round otherwise. The second ones are compiled anew, which takes a minute.
"""

import argparse
import itertools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator

_GENERIC = {'NUMBA_CPU_NAME': 'generic', 'NUMBA_CPU_FEATURES': ''}


def main() -> None:
    """Compare, and print how many joints differ by how much."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('recording', type=Path)
    parser.add_argument('--model', default='default')
    parser.add_argument('--frames', type=int, default=1000, help='the first ones (%(default)s)')
    parser.add_argument('--save', type=Path, help='only estimate, and write the answers there')
    arguments = parser.parse_args()
    if arguments.save:
        np.save(arguments.save, _estimate(arguments))
        return
    with tempfile.TemporaryDirectory() as folder:
        native, generic = Path(folder, 'native.npy'), Path(folder, 'generic.npy')
        cache = {'NUMBA_CACHE_DIR': str(Path(folder, 'kernels'))}
        for path, variables in ((native, {}), (generic, _GENERIC | cache)):
            words = [*sys.argv, '--save', str(path)]
            subprocess.run([sys.executable, *words], env=os.environ | variables, check=True)  # noqa: S603
        _compare(np.load(native), np.load(generic))


def _estimate(arguments: argparse.Namespace) -> NDArray[np.float32]:
    """Return x, y, z and confidence of all joints, shape (n, 4)."""
    estimator = Estimator(load_model(arguments.model))
    rows = []
    for frame in itertools.islice(open_recording(arguments.recording), arguments.frames):
        answer = estimator.estimate(frame.depth, frame.labels, frame.camera)
        joints = np.concatenate([answer.positions, answer.confidence[..., None]], axis=-1)
        rows.append(joints.reshape(-1, 4))
    return np.concatenate(rows)


def _compare(native: NDArray[np.float32], generic: NDArray[np.float32]) -> None:
    moved = np.linalg.norm(native[:, :3] - generic[:, :3], axis=1)
    known = np.isfinite(moved)
    print(f'{len(moved)} joints, {(native != generic).any(axis=1).sum()} with other bits')  # noqa: T201
    for limit in (1e-5, 1e-3, 1e-2, 1e-1):
        print(f'{100 * (moved[known] > limit).mean():.3f} % moved by more than {limit:g} m')  # noqa: T201
    only_one = np.isfinite(native[:, 0]) != np.isfinite(generic[:, 0])
    print(f'{only_one.sum()} joints are found on one of the two only')  # noqa: T201
    print(f'{moved[known].mean():.2g} m on average')  # noqa: T201


if __name__ == '__main__':
    main()
