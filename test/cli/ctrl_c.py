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

"""Sends Ctrl-C to each command at random moments: `python test/cli/ctrl_c.py --signals 300`."""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.messages.codecs.png import write_png
from lsc_pose_ros.ros.isolation import isolated_environment

LINE = b'lsc_pose: interrupted\n'

# A line says that the interpreter has started; before, Python itself prints a traceback.
_PROGRAM = """
import os, sys
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from lsc_pose_ros.cli.program import main
os.write(1, b'started\\n')
sys.exit(main())
"""


class Tried(NamedTuple):
    """A command that is interrupted.

    Attributes:
        words: the command.
        outputs: what it writes.
        lasts: how long it is watched, if it does not end by itself, seconds.
    """

    words: list[str]
    outputs: list[str]
    lasts: float | None = None


def commands(recording: Path) -> dict[str, Tried]:
    """Return the commands; they read `recording` and run in a folder of their own."""
    given = str(recording)
    images = str(make_images(recording.with_name('images')))
    return {
        'synth': Tried(['synth', 'out.mcap', '--frames', '30'], ['out.mcap']),
        'synth to a folder': Tried(['synth', 'out', '--frames', '30'], ['out']),
        'train': Tried(['train', given, '-o', 'out.npz', '--json', 'out.json'],
                       ['out.npz', 'out.json']),
        'evaluate': Tried(['evaluate', given, '--json', 'out.json', '--report', 'report'],
                          ['out.json']),
        'replay': Tried(['replay', given, '-o', 'out.mcap'], ['out.mcap']),
        'replay of people': Tried(['replay', given, '-o', 'out.mcap', '--segmentation', 'people'],
                                  ['out.mcap']),
        'view': Tried(['view', given, '-o', 'out.png', '--frames', '4'], ['out.png']),
        'bench': Tried(['bench', given, '--json', 'out.json'], ['out.json']),
        'info': Tried(['info', given, '--json', 'out.json'], ['out.json']),
        'export': Tried(['export', given, '-o', 'out.csv'], ['out.csv']),
        'label': Tried(['label', given, '--from', 'skeletons', '-o', 'out.mcap', '--topic',
                        '/ground_truth/skeletons', '--report', 'report'], ['out.mcap', 'report']),
        'import': Tried(['import', 'images', images, 'out.mcap'], ['out.mcap']),
        'experiments': Tried(['experiments', 'out', '--recordings', given, '--only', 'fig6',
                              '--quick'], ['out']),
        'annotate': Tried(['annotate', given, '-o', 'out.mcap', '--no-browser', '--port', '0'],
                          [], lasts=8.0),
        **({'replay to ROS': Tried(['replay', given, '--publish', '--loop'],
                                   [], lasts=8.0)} if find_spec('rclpy') else {}),
    }  # fmt: skip


def make_images(folder: Path) -> Path:
    """Return a folder of depth images with their intrinsics."""
    if not folder.exists():
        folder.mkdir()
        for number in range(20):
            pixels = np.full((60, 80), 2000 + number, np.uint16)
            (folder / f'{number:04}.png').write_bytes(write_png(pixels))
        words = '{"fx": 70.0, "fy": 70.0, "cx": 39.5, "cy": 29.5}'
        (folder / 'camera.json').write_text(words, encoding='utf-8')
    return folder


def start(words: Sequence[str], folder: Path) -> 'subprocess.Popen[bytes]':
    """Start a command in `folder` and wait until it can be interrupted."""
    process = subprocess.Popen(
        [sys.executable, '-c', _PROGRAM, *words],
        cwd=folder,
        env=os.environ | isolated_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    process.stdout.readline()
    return process


def duration(tried: Tried) -> float:
    """Return how long the command takes if nothing interrupts it, seconds."""
    if tried.lasts is not None:
        return tried.lasts
    with tempfile.TemporaryDirectory() as folder:
        process = start(tried.words, Path(folder))
        begin = time.monotonic()
        _, printed = process.communicate()
        if process.returncode:
            raise RuntimeError(printed.decode())
        return time.monotonic() - begin


def interrupt(tried: Tried, delay: float) -> str:
    """Interrupt the command after `delay` seconds; return what is wrong, '' if nothing is."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for output in tried.outputs:
            (folder / output).touch() if '.' in output else None
        process = start(tried.words, folder)
        try:
            process.wait(delay)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        _, printed = process.communicate()
        return _fault(process.returncode, printed, folder, tried)


def _fault(status: int, printed: bytes, folder: Path, tried: Tried) -> str:
    if status and status != 130:
        return f'status {status}: {printed.decode()}'
    if status == 130 and printed != LINE:
        return f'printed {printed.decode()}'
    half = [path.name for path in folder.iterdir() if path.name.startswith('.')]
    if half:
        return f'left {half}'
    missing = [each for each in tried.outputs if not (folder / each).exists()]
    if status == 0 and missing:
        return f'{missing} are missing'
    return ''


def make_recording(folder: Path, frames: int) -> Path:
    """Return a new labelled recording."""
    path = folder / 'given.mcap'
    words = ['synth', str(path), '--frames', str(frames), '--seed', '3']
    start(words, folder).communicate()
    return path


def main() -> int:
    """Interrupt all commands in turn, and print what goes wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--signals', type=int, default=300, help='how many (%(default)s)')
    parser.add_argument('--only', nargs='+', metavar='COMMAND', help='only these commands')
    parser.add_argument('--seed', type=int, default=0, help='seed of the moments (%(default)s)')
    arguments = parser.parse_args()
    moments = random.Random(arguments.seed)  # noqa: S311 - no secret
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        tried = commands(make_recording(Path(folder), 40))
        tried = {name: tried[name] for name in arguments.only or tried}
        durations = {name: duration(each) for name, each in tried.items()}
        for number in range(arguments.signals):
            name = list(tried)[number % len(tried)]
            delay = moments.uniform(0, durations[name])
            fault = interrupt(tried[name], delay)
            faults += bool(fault)
            if fault:
                sys.stdout.write(f'{name}, after {delay:.3f} s: {fault}\n')
                sys.stdout.flush()
    sys.stdout.write(f'{arguments.signals} signals, {faults} faults\n')
    return int(faults > 0)


if __name__ == '__main__':
    sys.exit(main())
