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
"""Whether the live node survives a long time of faults: `make soak MINUTES=30`.

A camera with a segmentation sends images at 30 Hz; people come and go, and a tenth of the frames
has a fault of soak_camera.py. The report, OUTPUT/soak.json, and the plot, soak.png, tell how many
of the frames without faults were answered, how many were left out for which reason, how memory
went, and the latencies. The exit status is 1 if the node has ended, if frames are unaccounted
for, if no frame was answered for 30 s, or if memory grew by 5 MB or more after the first fifth of
at least ten minutes.
"""

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from live_run import Observed, memory_of, observe, told_of
from matplotlib.figure import Figure

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.machine import describe_machine, versions
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

_HERE = Path(__file__).parent
_SHOWN = SyntheticSettings(
    frames=60, seed=2, clip_length=60, rate=30.0, width=320, height=240, people=2
)
_DROPS = (
    'replaced', 'lost', 'missing', 'unmatched depth', 'unmatched masks', 'duplicates', 'late',
    'failed', 'rewinds',
)  # fmt: skip

MOST_GROWTH = 5.0
"""Memory may grow by less than so many MB."""

MOST_PAUSE = 30.0
"""Seconds without any answer; one frame takes less on the slowest computer."""

_LEAST_SECONDS = 600.0
_STILL_WAITING = 2


def main() -> int:
    """Soak and report; return the exit status."""
    arguments = _parser().parse_args()
    seconds = arguments.seconds or 60.0 * arguments.minutes
    try:
        arguments.output.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix='lsc_pose_soak_') as name:
            report = _soak(arguments, seconds, Path(name))
        write_json(arguments.output / 'soak.json', report)
        _plot(report).savefig(arguments.output / 'soak.png', dpi=100)
    except InputError as error:
        sys.stderr.write(f'soak: error: {error}\n')
        return 2
    sys.stdout.write(_text(report))
    return 1 if report['complaints'] else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--minutes', type=float, default=30.0)
    parser.add_argument('--seconds', type=float, help='instead of --minutes')
    parser.add_argument('--rate', type=float, default=30.0, help='images a second')
    parser.add_argument('--faults', type=float, default=0.1, help='share of frames with faults')
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--model', default='', help="the node's; default: that of the package")
    parser.add_argument('-o', '--output', type=Path, default=Path('soak'))
    return parser


def _soak(arguments: argparse.Namespace, seconds: float, folder: Path) -> dict[str, Any]:
    recording = folder / 'shown.mcap'
    with RecordingWriter(recording) as writer:
        for frame in synthetic_frames(_SHOWN):
            writer.write_frame(frame)
    model = find_model(arguments.model)
    camera_words = [
        str(_HERE / 'soak_camera.py'), str(recording), '--rate', str(arguments.rate),
        '--seconds', str(seconds), '--seed', str(arguments.seed),
        '--faults', str(arguments.faults),
    ]  # fmt: skip
    observed = observe(['-p', f'model:={model}'], camera_words, folder)
    log = (folder / 'node.log').read_text(encoding='utf-8')
    return _report(observed, log) | {
        'machine': describe_machine(),
        'versions': versions(),
        'model': str(arguments.model or model.name),
    }


def _report(observed: Observed, log: str) -> dict[str, Any]:
    shown, heard = observed.camera, observed.heard
    good = set(shown['good'])
    answers = [(stamp, arrival) for stamp, arrival, _ in heard['answers']]
    latencies = [(stamp, 1e-6 * (arrival - stamp)) for stamp, arrival in answers if stamp in good]
    if not latencies or not heard['diagnostics']:
        msg = 'the node has answered no frame'
        raise InputError(msg)
    values = heard['diagnostics'][-1][1]
    drops = {name: int(values.get(name, 0)) for name in _DROPS}
    received = int(values['depth'])
    unaccounted = max(received - len(answers) - told_of(drops) - drops['failed'], 0)
    milliseconds = [latency for _, latency in latencies]
    arrivals = [1e-9 * arrival for _, arrival in answers]
    pauses = np.diff(arrivals, append=arrivals[0] + shown['seconds'])
    report = {
        'seconds': shown['seconds'],
        'sent': shown['sent'],
        'faults': shown['faults'],
        'good': len(good),
        'answered': len(latencies),
        'answers_to_faults': len(answers) - len(latencies),
        'received': received,
        'drops': drops,
        'unaccounted': unaccounted,
        'latency_ms': {str(p): float(np.percentile(milliseconds, p)) for p in (50, 95, 99, 100)},
        'longest_pause': float(pauses.max()),
        'latencies': latencies[:: max(len(latencies) // 2000, 1)],
        'memory_mb': memory_of(observed.usages),
        'log_bytes': len(log),
        'tracebacks': log.count('Traceback'),
    }
    return report | {'complaints': _complaints(report, ended=observed.ended)}


def _complaints(report: dict[str, Any], *, ended: bool) -> list[str]:
    """Return what is not as it should be."""
    complaints = []
    if ended:
        complaints.append('the node has ended')
    if report['tracebacks']:
        complaints.append(f'{report["tracebacks"]} tracebacks in the log')
    if report['unaccounted'] > _STILL_WAITING:
        complaints.append(f'{report["unaccounted"]} frames are neither answered nor counted')
    if report['longest_pause'] > MOST_PAUSE:
        complaints.append(f'no frame was answered for {report["longest_pause"]:.0f} s')
    growth = report['memory_mb']['typical_growth']
    if report['seconds'] >= _LEAST_SECONDS and growth >= MOST_GROWTH:
        complaints.append(f'memory grew by {growth:.1f} MB')
    return complaints


def _text(report: dict[str, Any]) -> str:
    drops = ', '.join(f'{count} {name}' for name, count in report['drops'].items() if count)
    latency, memory = report['latency_ms'], report['memory_mb']
    faults = sum(report['faults'].values())
    start, end = memory['typical_start'], memory['typical_end']
    lines = [
        f'{report["sent"]} frames in {report["seconds"]:.0f} s, {faults} with a fault',
        f'{report["answered"]} of {report["good"]} frames without a fault answered',
        f'received: {report["received"]}; counted: {drops or "none"}',
        f'unaccounted: {report["unaccounted"]}',
        f'longest time without an answer: {report["longest_pause"]:.1f} s',
        'latency, ms: ' + ', '.join(f'{value:.1f} (p{p})' for p, value in latency.items()),
        f'memory {start:.1f} MB at the start, {end:.1f} MB at the end',
        f'log {report["log_bytes"]} bytes',
        *(f'NOT AS IT SHOULD BE: {each}' for each in report['complaints']),
    ]
    return ''.join(f'{line}\n' for line in lines)


def _plot(report: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(8, 5), layout='constrained')
    upper, lower = figure.subplots(2, 1, sharex=True)
    memory = report['memory_mb']
    upper.plot(memory['seconds'], memory['resident'])
    upper.set_ylabel('memory, MB')
    stamps, latencies = np.array(report['latencies']).T
    lower.plot((stamps - stamps[0]) / 1e9, latencies, '.', markersize=2)
    lower.set_yscale('log')
    lower.set_ylabel('latency, ms')
    lower.set_xlabel('seconds')
    return figure


if __name__ == '__main__':
    sys.exit(main())
