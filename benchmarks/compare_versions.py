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
"""Compares the speed of two source trees of this package on the same recording.

`python benchmarks/compare_versions.py OLD_TREE NEW_TREE RECORDING [--model MODEL]` runs
`lsc_pose evaluate` of both trees in turns, each in its own process, and prints the ratio of the
medians of a frame's processor time, new to old: below 1 the new tree is faster. Other load on the
machine hardly changes the processor time. RECORDING needs ground truth.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

_ROUNDS = 5

# Estimation runs in one thread; `evaluate` times it with `perf_counter`.
_PROGRAM = """
import runpy, time
time.perf_counter = time.thread_time
runpy.run_module('lsc_pose_ros', run_name='__main__', alter_sys=True)
"""


def main() -> int:
    """Run both trees in turns and print the ratio; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('old', type=Path, metavar='OLD_TREE', help='a checkout of this package')
    parser.add_argument('new', type=Path, metavar='NEW_TREE', help='another one')
    parser.add_argument('recording', type=Path, metavar='RECORDING')
    parser.add_argument(
        '--model', default='default', help="a file, or a name that both trees have ('default')"
    )
    parser.add_argument(
        '--rounds', type=int, default=_ROUNDS, help='runs of each tree (default: %(default)s)'
    )
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trees = {
            name: (tree.resolve(), Path(folder, name))
            for name, tree in (('old', arguments.old), ('new', arguments.new))
        }
        for tree, work in trees.values():
            work.mkdir()
            median_ms(tree, work, arguments.recording, arguments.model)  # compiles the kernels
        times: dict[str, list[float]] = {name: [] for name in trees}
        for number in range(arguments.rounds):
            # The order alternates, so that a load that rises or falls slows down both alike.
            for name in sorted(trees, reverse=number % 2 == 0):
                tree, work = trees[name]
                median = median_ms(tree, work, arguments.recording, arguments.model)
                times[name].append(median)
                sys.stdout.write(f'{name}: {median:.3f} ms\n')
    ratios = [new / old for old, new in zip(times['old'], times['new'], strict=True)]
    sys.stdout.write(
        f'ratio of medians, new to old: {ratio(times["new"], times["old"]):.3f} '
        f'(round by round: {", ".join(f"{each:.3f}" for each in ratios)})\n'
    )
    return 0


def ratio(first: list[float], second: list[float]) -> float:
    """Return the median of `first` divided by that of `second`."""
    return statistics.median(first) / statistics.median(second)


def median_ms(tree: Path, work: Path, recording: Path, model: str) -> float:
    """Return the median processor time of a frame of `recording`, ms, in a process of its own.

    Args:
        tree: the checkout that the process imports the package from.
        work: a folder for the result and for compiled kernels.
        recording: the frames.
        model: a file, or the name of a model in the tree.
    """
    result = work / 'evaluation.json'
    model_path = str(Path(model).resolve()) if Path(model).is_file() else model
    command = [sys.executable, '-c', _PROGRAM, 'evaluate', model_path]
    subprocess.run(  # noqa: S603 - this very package
        [*command, str(recording.resolve()), '--json', str(result)],
        check=True,
        cwd=work,
        env=os.environ | {'PYTHONPATH': str(tree), 'NUMBA_CACHE_DIR': str(work)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return float(json.loads(result.read_text(encoding='utf-8'))['ms_per_frame']['p50'])


if __name__ == '__main__':
    sys.exit(main())
