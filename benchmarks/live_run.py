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
"""One measurement of the live node: node, camera and listener, each in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from process_usage import Usage, read_usage

import lsc_pose_ros
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.isolation import isolated_environment

_HERE = Path(__file__).parent
_START_TIMEOUT = 900.0  # a slow, busy computer compiles the kernels for minutes
_END_TIMEOUT = 20.0
_SAMPLING_PERIOD = 1.0
_SAMPLES = 100  # about so many readings of the memory are kept in the results
_LAST_DIAGNOSTICS = 2.5  # the node publishes them each second

# The node's counters of what is left unanswered.
_DROPS = (
    'replaced', 'lost', 'missing', 'unmatched depth', 'unmatched masks', 'duplicates', 'late',
)  # fmt: skip
_STAGES = ('decode', 'estimate', 'publish')


class Setup(NamedTuple):
    """What is measured.

    Attributes:
        width: of the images, pixels.
        height: of the images, pixels.
        rate: images a second.
        seconds: how long it is measured.
        settle: how long it runs before that, seconds.
        reliable: whether the images are offered reliably; otherwise as sensors do.
        room: whether there are no masks, so that the node finds the people.
    """

    width: int
    height: int
    rate: float
    seconds: float
    settle: float
    reliable: bool = False
    room: bool = False

    @property
    def size(self) -> str:
        """As it is written on the command line."""
        return f'{self.width}x{self.height}'


class Observed(NamedTuple):
    """What one run gives.

    Attributes:
        camera: what the camera says it has done.
        heard: what the listener has noted.
        usages: readings of the node's process, from before the first image on.
        ended: whether the node ended before it was told to.
    """

    camera: dict[str, Any]
    heard: dict[str, Any]
    usages: list[Usage]
    ended: bool


def measure(setup: Setup, recording: Path, model: Path, folder: Path) -> dict[str, Any]:
    """Return how the live node does.

    Args:
        setup: what is measured.
        recording: the frames that the camera shows, over and over.
        model: the node's.
        folder: for the logs.

    Raises:
        InputError: one of the programs does not do its part.
    """
    before = os.getloadavg()[0]
    node_words = ['-p', f'model:={model}', *(['-p', 'segmentation:=people'] if setup.room else [])]
    camera_words = [
        str(_HERE / 'live_camera.py'), str(recording), '--rate', str(setup.rate),
        '--seconds', str(setup.settle + setup.seconds),
        *(['--reliable'] if setup.reliable else []),
        *(['--without-masks'] if setup.room else []),
    ]  # fmt: skip
    observed = observe(node_words, camera_words, folder)
    return _summary(setup, observed, (before, os.getloadavg()[0]))


def observe(node_words: Sequence[str], camera_words: Sequence[str], folder: Path) -> Observed:
    """Run the node and a listener for as long as the camera shows images.

    Args:
        node_words: the ROS arguments of the node.
        camera_words: the program of the camera, which ends with its own words in JSON.
        folder: for the logs node.log, listener.log and camera.log.

    Raises:
        InputError: one of the programs does not do its part.
    """
    environment = own_environment()
    notes = folder / 'heard.json'
    words = ['-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *node_words]
    listener_words = [str(_HERE / 'live_listener.py'), str(notes)]
    with (
        run_program(words, folder / 'node.log', environment) as node,
        run_program(listener_words, folder / 'listener.log', environment) as listener,
    ):
        wait_for('ready', node, folder / 'node.log')
        wait_for('listening', listener, folder / 'listener.log')
        with run_program(camera_words, folder / 'camera.log', environment) as camera:
            usages = list(sample(node, camera))
        told = (folder / 'camera.log').read_text(encoding='utf-8')
        if camera.returncode or node.poll() is not None:
            raise InputError(failure(folder))
        time.sleep(_LAST_DIAGNOSTICS)
        end_input(listener)
        ended = node.poll() is not None
    return Observed(
        json.loads(told.splitlines()[-1]),
        json.loads(notes.read_text(encoding='utf-8')),
        usages,
        ended,
    )


def own_environment() -> dict[str, str]:
    """Return the variables of an isolated ROS domain, for programs that use this package."""
    # Our programs find the package where this one has found it.
    paths = [str(Path(lsc_pose_ros.__file__).parents[1]), os.environ.get('PYTHONPATH', '')]
    return isolated_environment() | {'PYTHONPATH': os.pathsep.join(filter(None, paths))}


@contextmanager
def run_program(
    words: Sequence[str], log: Path, environment: Mapping[str, str]
) -> Iterator[subprocess.Popen[bytes]]:
    """Run a Python program; it is ended at the end, where it has not ended by itself."""
    with log.open('wb') as output:
        process = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, *words],
            stdin=subprocess.PIPE,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=os.environ | environment,
            start_new_session=True,
        )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(_END_TIMEOUT)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        end_input(process)


def end_input(process: subprocess.Popen[bytes]) -> None:
    """Close the standard input of a program, and wait until it has ended."""
    if process.stdin is not None and not process.stdin.closed:
        process.stdin.close()
        if process.poll() is None:
            process.wait(_END_TIMEOUT)


def wait_for(word: str, process: subprocess.Popen[bytes], log: Path) -> None:
    """Wait until a program has written `word`.

    Raises:
        InputError: it has ended, or takes too long.
    """
    deadline = time.monotonic() + _START_TIMEOUT
    while word not in log.read_text(encoding='utf-8'):
        if process.poll() is not None or time.monotonic() > deadline:
            raise InputError(failure(log.parent))
        time.sleep(0.05)


def failure(folder: Path) -> str:
    """Return what the logs in `folder` say."""
    logs = (path.read_text(encoding='utf-8').strip() for path in sorted(folder.glob('*.log')))
    told = ' / '.join(' '.join(log.split()) for log in logs if log)
    return f'the live node was not measured; the programs say: {told}'


def sample(node: subprocess.Popen[bytes], camera: subprocess.Popen[bytes]) -> Iterator[Usage]:
    """Yield what the node takes, while the camera is there."""
    while camera.poll() is None and node.poll() is None:
        yield read_usage(node.pid)
        time.sleep(_SAMPLING_PERIOD)


def _summary(setup: Setup, observed: Observed, load: tuple[float, float]) -> dict[str, Any]:
    camera = observed.camera
    begin = camera['begin'] + round(1e9 * setup.settle)
    end = camera['begin'] + round(1e9 * camera['seconds'])
    answers = observed.heard['answers']
    latencies = [1e-6 * (arrival - stamp) for stamp, arrival, _ in answers if begin <= stamp < end]
    arrived = sum(begin <= arrival < end for _, arrival, _ in answers)
    usages = [usage for usage in observed.usages if begin <= usage.time < end]
    if not latencies or len(usages) < 2:
        msg = 'no answers came, or too few to measure; give more --seconds'
        raise InputError(msg)
    diagnostics = observed.heard['diagnostics']
    drops = {name: int(diagnostics[-1][1][name]) for name in _DROPS} if diagnostics else None
    return {
        'size': setup.size,
        'shows': 'two people, no masks' if setup.room else 'one person, masks',
        'rate': setup.rate,
        'seconds': setup.seconds,
        'reliable': setup.reliable,
        'sent_per_second': camera['sent'] / camera['seconds'],
        'answers_per_second': arrived / (1e-9 * (end - begin)),
        'latency_ms': {
            'p50': float(np.percentile(latencies, 50)),
            'p95': float(np.percentile(latencies, 95)),
            'max': max(latencies),
        },
        'processor_share': _share(usages),
        'memory_mb': memory_of(usages),
        'sent': camera['sent'],
        'answers': len(answers),
        'joints_an_answer': float(np.mean([found for *_, found in answers])),
        'drops': drops,
        'unaccounted': camera['sent'] - len(answers) - told_of(drops) if drops else None,
        'stages_ms_p50': _stages([values for time, values in diagnostics if time >= begin]),
        'load_average': {'before': load[0], 'after': load[1]},
    }


def told_of(drops: Mapping[str, int]) -> int:
    """Return how many images stayed unanswered, but were counted where they were left out."""
    return sum(drops[name] for name in ('replaced', 'unmatched depth', 'duplicates', 'late'))


def _share(usages: Sequence[Usage]) -> float:
    """Return how much of one core the node takes."""
    first, last = usages[0], usages[-1]
    return (last.processor - first.processor) / (1e-9 * (last.time - first.time))


def memory_of(usages: Sequence[Usage]) -> dict[str, Any]:
    """Return how memory goes.

    A reading may fall into a frame's work, which takes megabytes for some milliseconds; the
    typical start and end, medians of the first and last fifth, hardly show that.
    """
    resident = [1e-6 * usage.resident for usage in usages]
    some = max(len(resident) // 5, 1)
    start, end = float(np.median(resident[:some])), float(np.median(resident[-some:]))
    every = max(len(usages) // _SAMPLES, 1)
    return {
        'start': resident[0],
        'end': resident[-1],
        'largest_growth': max(resident) - resident[0],
        'typical_start': start,
        'typical_end': end,
        'typical_growth': end - start,
        'private_end': 1e-6 * usages[-1].private,
        'seconds': [1e-9 * (usage.time - usages[0].time) for usage in usages[::every]],
        'resident': resident[::every],
    }


def _stages(diagnostics: Sequence[Mapping[str, str]]) -> dict[str, float]:
    """Return what the node itself measures, the median over the seconds."""
    stages = {}
    for stage in _STAGES:
        key = f'{stage} p50 (ms)'
        told = [float(values[key]) for values in diagnostics if key in values]
        if told:
            stages[stage] = float(np.median(told))
    return stages
