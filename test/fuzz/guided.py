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

"""Fuzzes the readers guided by coverage: `make fuzz-guided MINUTES=10`.

Atheris keeps inputs that reach new lines of a reader, and changes those further. `fuzzing.py` says
what a reader must not do.
"""

import argparse
import importlib
import io
import pkgutil
import subprocess
import sys
import tempfile
import tracemalloc
import zipfile
from pathlib import Path

import atheris

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # tiny_model

_INSTRUMENTED = [
    'lsc_pose_ros.bags', 'lsc_pose_ros.labels', 'lsc_pose_ros.messages', 'lsc_pose_ros.model_io',
    'lsc_pose_ros.resources', 'lsc_pose_ros.synthetic.mocap', 'mcap', 'rosbags', 'yaml', 'zipfile',
]  # fmt: skip
"""The readers, which Atheris instruments."""

_COMPILED = ['body_parts', 'camera', 'numerics', 'pose', 'segmentation', 'tracking']
"""The packages with kernels, which are loaded as they are: numba cannot compile them otherwise."""

importlib.import_module('lsc_pose_ros.messages.codecs.rvl')
for _name in _COMPILED:
    _package = importlib.import_module(f'lsc_pose_ros.{_name}')
    for _found in pkgutil.walk_packages(_package.__path__, f'{_package.__name__}.'):
        importlib.import_module(_found.name)

with atheris.instrument_imports(include=_INSTRUMENTED):
    from fuzz_targets import Target, targets
    from fuzzing import MOST_MEMORY, MOST_SECONDS, check

_MEBIBYTE = 1 << 20
_PROCESS_MEMORY = 1024 * _MEBIBYTE  # of the process itself, with the compiled kernels


def corpus_of(target: Target) -> list[bytes]:
    """Return the inputs to begin with; in an archive, a byte says which part is replaced."""
    if not target.archive:
        return target.seeds
    with zipfile.ZipFile(io.BytesIO(target.seeds[0])) as archive:
        return [bytes([n]) + archive.read(name) for n, name in enumerate(archive.namelist())]


def with_part(data: bytes, changed: bytes) -> bytes:
    """Return the archive `data` with one part replaced: the first byte of `changed` says which."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, 'w') as new:
        names = old.namelist()
        chosen = names[changed[0] % len(names)] if changed else ''
        for name in names:
            new.writestr(name, changed[1:] if name == chosen else old.read(name))
    return stream.getvalue()


def fuzz(name: str, seconds: int) -> None:
    """Fuzz one target; the process ends with it, with another status than 0 for a finding."""
    target = targets()[name]
    for data in target.seeds:
        target.read(data)  # compiles the kernels, which may take longer than an input may
    tracemalloc.start()

    def read(data: bytes) -> None:
        check(target, with_part(target.seeds[0], data) if target.archive else data)

    with tempfile.TemporaryDirectory() as folder:
        for number, data in enumerate(corpus_of(target)):
            Path(folder, str(number)).write_bytes(data)
        limit = (MOST_MEMORY + _PROCESS_MEMORY) // _MEBIBYTE
        options = [
            f'-max_total_time={seconds}', f'-timeout={MOST_SECONDS}', f'-rss_limit_mb={limit}',
            '-max_len=20000', '-verbosity=0', '-print_final_stats=1', folder,
        ]  # fmt: skip
        atheris.Setup([sys.argv[0], *options], read)
        atheris.Fuzz()


def main() -> int:
    """Fuzz each target in a process of its own; return 1 if something is found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--minutes', type=float, default=10.0, help='for each (%(default)s)')
    parser.add_argument('--only', nargs='+', metavar='TARGET', help='only these targets')
    parser.add_argument('--target', help='fuzz this target in this process')
    arguments = parser.parse_args()
    if arguments.target:
        fuzz(arguments.target, int(60 * arguments.minutes))
    findings = 0
    for name in arguments.only or targets():
        words = [sys.executable, __file__, '--target', name, '--minutes', str(arguments.minutes)]
        ended = subprocess.run(words, capture_output=True, check=False)
        findings += ended.returncode != 0
        told = ended.stderr.decode(errors='replace')
        runs = [line.split()[-1] for line in told.splitlines() if 'number_of_executed' in line]
        print(f'{name}: {runs[0] if runs else "no"} inputs', flush=True)  # noqa: T201
        if ended.returncode:
            print(told, flush=True)  # noqa: T201
    return int(findings > 0)


if __name__ == '__main__':
    sys.exit(main())
