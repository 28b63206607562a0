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
"""How the live node does: answers a second, latency, processor and memory, over real ROS 2.

`python benchmarks/live.py` measures 640x480 and 320x240 at 30 Hz, the first also with two people
in a furnished room without masks, and, for five minutes, 640x480 at 120 Hz. It writes
results_live.json and the table of README.md beside itself. With --size, --rate, --seconds or
--room it measures that alone, and writes a table to stdout.

Three processes: the node; a camera with a segmentation, whose images show one synthetic person
(or, without a segmentation, the room);
and a listener. Latency is from the depth image's stamp, which is when the camera publishes it, to
the arrival of its answer at the listener.
"""

import argparse
import datetime as dt
import sys
import tempfile
from pathlib import Path
from typing import Any

from live_page import live_table, write_live_table
from live_run import Setup, measure

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.commands.bench_command import TRAINING
from lsc_pose_ros.cli.options.image_size import image_size
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.machine import describe_machine, versions
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import save_model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.training.train import TrainingSettings, train

SIZE = (640, 480)
RATE = 30.0
SECONDS = 30.0
SOAK_RATE = 120.0

_HERE = Path(__file__).parent
_SHOWN = SyntheticSettings(frames=60, seed=2, clip_length=60, rate=30.0)
_ROOM = _SHOWN._replace(seed=1, people=2, furniture=True)


def main() -> int:
    """Measure and write; return the exit status."""
    arguments = _parser().parse_args()
    try:
        results = measure_all(_setups(arguments), arguments.model)
        sys.stdout.write(f'{live_table(results["runs"])}\n')
        if arguments.json:
            write_json(arguments.json, results)
        elif _is_usual(arguments):
            write_json(_HERE / 'results_live.json', results)
            write_live_table(results, _HERE / 'README.md')
    except InputError as error:
        sys.stderr.write(f'live: error: {error}\n')
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--size', type=image_size, metavar='WIDTHxHEIGHT', help='of the images')
    parser.add_argument('--rate', type=float, metavar='HZ', help='images a second')
    parser.add_argument('--seconds', type=float, metavar='S', help='how long it is measured')
    parser.add_argument(
        '--settle', type=float, default=5.0, metavar='S',
        help='how long it runs before that (default: %(default)g)',
    )  # fmt: skip
    parser.add_argument(
        '--soak', type=float, default=300.0, metavar='S',
        help=f'how long {SOAK_RATE:g} Hz are measured (default: %(default)g)',
    )  # fmt: skip
    parser.add_argument(
        '--room', action='store_true',
        help='two people in a furnished room, without masks',
    )  # fmt: skip
    parser.add_argument(
        '--reliable', action='store_true',
        help='the camera offers its images reliably (default: best effort, as sensors do)',
    )  # fmt: skip
    parser.add_argument(
        '--model', type=Path, metavar='FILE',
        help='default: a small one, trained on synthetic people',
    )  # fmt: skip
    parser.add_argument(
        '--json', type=Path, metavar='FILE',
        help='write the results there, and leave README.md alone',
    )  # fmt: skip
    return parser


def _is_usual(arguments: argparse.Namespace) -> bool:
    return not (arguments.size or arguments.rate or arguments.seconds or arguments.room)


def _setups(arguments: argparse.Namespace) -> list[Setup]:
    common = (arguments.settle, arguments.reliable)
    if _is_usual(arguments):
        return [
            Setup(640, 480, RATE, SECONDS, *common),
            Setup(640, 480, RATE, SECONDS, *common, room=True),
            Setup(320, 240, RATE, SECONDS, *common),
            Setup(640, 480, SOAK_RATE, arguments.soak, *common),
        ]
    width, height = arguments.size or SIZE
    rate, seconds = arguments.rate or RATE, arguments.seconds or SECONDS
    return [Setup(width, height, rate, seconds, *common, room=arguments.room)]


def measure_all(setups: list[Setup], model: Path | None) -> dict[str, Any]:
    """Return what is measured for each of `setups`, as `live_page` reads it.

    Args:
        setups: what to measure.
        model: the node's model file; None for a small one.

    Raises:
        InputError: ROS 2 is not there, or the model cannot be used.
    """
    with tempfile.TemporaryDirectory(prefix='lsc_pose_live_') as name:
        folder = Path(name)
        chosen = model or _trained(folder)
        runs = []
        for setup in setups:
            recording = _shown(setup, folder)
            tell(f'{setup.size} at {setup.rate:g} Hz for {setup.seconds:g} s')
            runs.append(measure(setup, recording, chosen, folder))
    return {
        'date': dt.datetime.now(tz=dt.timezone.utc).date().isoformat(),
        'machine': describe_machine(),
        'versions': versions(),
        'model': str(model) if model else f'trained on {TRAINING.frames} synthetic frames',
        'runs': runs,
    }


def _trained(folder: Path) -> Path:
    tell(f'training a small model on {TRAINING.frames} synthetic frames')
    training = TrainingSettings(numbers_of(DEFAULT_JOINTS))
    path = folder / 'model.npz'
    model = train(synthetic_frames(TRAINING), training, {'recordings': 'synthetic'})
    save_model(path, model)
    return path


def _shown(setup: Setup, folder: Path) -> Path:
    """Return a recording of what the camera shows: people who move for two seconds."""
    path = folder / f'{setup.size}{"_room" if setup.room else ""}.mcap'
    if not path.exists():
        settings = (_ROOM if setup.room else _SHOWN)._replace(
            width=setup.width, height=setup.height
        )
        with RecordingWriter(path) as writer:
            for frame in synthetic_frames(settings):
                writer.write_frame(frame)
    return path


def tell(sentence: str) -> None:
    """Say on stderr what is being done."""
    sys.stderr.write(f'live: {sentence}\n')


if __name__ == '__main__':
    sys.exit(main())
