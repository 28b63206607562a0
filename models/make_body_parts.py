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


# ruff: noqa: INP001, T201 - a program, not a package
"""Train the network of body parts of the package: `make body-parts`.

The program draws furnished synthetic rooms and trains the network on them; it needs PyTorch. The
depth grids of each recording and the state of the training are kept in a folder, so the program
can be interrupted and started again.

    python models/make_body_parts.py --mocap CLIPS
"""

import argparse
import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from body_part_scenes import FRAMES, any_room, draw_grids, load_grids
from part_network_training import TrainingPlan, train_part_network
from people import MocapSplit, RecordingSpec, find_mocap

from lsc_pose_ros.model_io.part_network_file import save_part_network
from lsc_pose_ros.resources.package_files import resource

HERE = Path(__file__).resolve().parent

ROOMS = range(1_000, 1_000 + 240)
"""The numbers of the recordings."""


def main(words: Sequence[str] | None = None) -> int:
    """Make the network and return the exit status."""
    arguments = _parser().parse_args(words)
    arguments.directory.mkdir(parents=True, exist_ok=True)
    mocap = find_mocap(arguments.mocap, None) if arguments.mocap else MocapSplit()
    specs = [_scaled(any_room(number), arguments.scale) for number in ROOMS]
    with ProcessPoolExecutor(arguments.processes) as pool:
        count = len(specs)
        paths = list(pool.map(draw_grids, specs, [mocap] * count, [arguments.directory] * count))
    plan = TrainingPlan()
    plan = plan._replace(images=max(plan.batch, round(plan.images * arguments.scale)))
    state = arguments.directory / f'state_{count}_{plan.images}.pt'
    network = train_part_network([load_grids(path) for path in paths], plan, 0, state)
    provenance = {
        'frames': str(sum(spec.settings.frames for spec in specs)),
        'images': str(plan.images),
        'mocap': 'CMU' if arguments.mocap else 'none',
    }
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    save_part_network(arguments.output, network, provenance)
    print(json.dumps(provenance | {'bytes': arguments.output.stat().st_size}, indent=1))
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='models/make_body_parts.py', description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    folder = HERE.parent / 'build' / 'body_parts'
    output = resource('models').parent / 'body_parts' / 'body_parts.npz'
    parser.add_argument('--directory', type=Path, default=folder, help='folder of the samples')
    parser.add_argument('--output', type=Path, default=output, help='the file of the network')
    parser.add_argument('--mocap', type=Path, help='folder of motion capture (BVH)')
    parser.add_argument('--scale', type=float, default=1.0, help='fraction of frames and images')
    parser.add_argument('--processes', type=int, default=2, help='processes that draw rooms')
    return parser


def _scaled(spec: RecordingSpec, scale: float) -> RecordingSpec:
    frames = max(1, round(scale * FRAMES))
    return spec._replace(settings=spec.settings._replace(frames=frames))


if __name__ == '__main__':
    sys.exit(main())
