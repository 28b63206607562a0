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
"""Writes the results of `live.py` as a table."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import TEXT
from lsc_pose_ros.files.output_file import write_output

_PATTERN = re.compile(r'(<!-- live -->\n).*(<!-- live end -->)', re.DOTALL)

_HEAD = [
    'images', 'frames/s', 'latency p50, ms', 'p95', 'max', 'CPU, % of a core', 'memory, MB',
    'growth', 'at most', 'sent', 'left out for newer', 'unaccounted', 'load average',
]  # fmt: skip


def write_live_table(results: dict[str, Any], path: Path) -> None:
    """Replace the table of the page at `path` by that of `results`.

    Raises:
        InputError: the page has no marks for the table.
    """
    page = path.read_text(encoding='utf-8')
    if not _PATTERN.search(page):
        msg = f'{path}: no lines <!-- live --> and <!-- live end -->; add them for the table'
        raise InputError(msg)
    text = f'{_machine(results)}\n\n{live_table(results["runs"])}'
    page = _PATTERN.sub(lambda found: f'{found[1]}\n{text}\n\n{found[2]}', page)
    write_output(path, TEXT, page.encode())


def live_table(runs: Sequence[dict[str, Any]]) -> str:
    """Return a Markdown table with one row per run."""
    lines = [_HEAD, ['---', *('---:' for _ in _HEAD[1:])], *(_row(run) for run in runs)]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)


def _machine(results: dict[str, Any]) -> str:
    machine = results['machine']
    used = ', '.join(f'{name} {version}' for name, version in results['versions'].items())
    return (
        f'Measured on {results["date"]}: {machine["cores"]} cores of an {machine["processor"]}; '
        f'{used}.'
    )


def _row(run: dict[str, Any]) -> list[str]:
    latency, memory, load = run['latency_ms'], run['memory_mb'], run['load_average']
    drops = run['drops']
    return [
        f'{run["size"]} at {run["rate"]:g} Hz, {run["seconds"]:g} s, {run["shows"]}',
        f'{run["answers_per_second"]:.1f}',
        f'{latency["p50"]:.1f}',
        f'{latency["p95"]:.1f}',
        f'{latency["max"]:.0f}',
        f'{100 * run["processor_share"]:.0f}',
        f'{memory["end"]:.0f}',
        f'{memory["typical_growth"]:.1f}',
        f'{memory["largest_growth"]:.1f}',
        str(run['sent']),
        str(drops['replaced']) if drops else '-',
        str(run['unaccounted']) if drops else '-',
        f'{load["before"]:.1f}-{load["after"]:.1f}',
    ]
