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

"""Changes good bytes in many ways, and checks what their reader does: `make fuzz MINUTES=10`."""

import argparse
import io
import signal
import sys
import time
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # tiny_model

from fuzz_targets import Target, targets
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from lsc_pose_ros.errors import InputError

MOST_SECONDS = 20
"""A reader that takes longer hangs; the inputs are a few kilobytes."""

MOST_MEMORY = 200 << 20
"""A reader that allocates more is led by the nose, bytes."""

LONGEST_MESSAGE = 1000

# Numbers that break arithmetic, in bytes, and words that break parsers.
PIECES = [
    b'', b'\0', b'\xff', b'\xff' * 4, b'\x7f\xff\xff\xff', b'\xff\xff\xff\x7f', b'\0' * 8,
    b'\xff' * 8, b'\0\0\xc0\x7f', b'\xff\xff\x7f\x7f', b'\0\0\x80\xff', b'-1', b'1e999', b'nan',
    b'9' * 40, b'9' * 400, b'[' * 50, b'null', b'NaN', b'Infinity', b'1e-400', b'-5', b'{}',
    b'{', b'\n', b'&a [*a]', b'*a', b'&a ', b'1:1:1', b'../../etc/passwd',
    b'!!python/object:os.system', b'\xc3\x28',
]  # fmt: skip


@st.composite
def changes(draw: st.DrawFn) -> list[tuple[float, int, bytes]]:
    """Return changes: a place, how many bytes are replaced, and by what."""
    piece = st.sampled_from(PIECES) | st.binary(max_size=8)
    change = st.tuples(st.floats(0, 1, width=32), st.integers(0, 40), piece)
    return draw(st.lists(change, min_size=1, max_size=6))


def change_bytes(data: bytes, edits: list[tuple[float, int, bytes]]) -> bytes:
    """Return `data` with the edits; 40 replaced bytes stand for all that follow."""
    changed = bytearray(data)
    for place, length, piece in edits:
        start = int(place * len(changed))
        changed[start : len(changed) if length == 40 else start + length] = piece
    return bytes(changed)


def change_archive(data: bytes, edits: list[tuple[float, int, bytes]], which: int) -> bytes:
    """Return the archive `data` with the edits in one of its parts."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, 'w') as new:
        names = old.namelist()
        for number, name in enumerate(names):
            part = old.read(name)
            new.writestr(name, change_bytes(part, edits) if number == which % len(names) else part)
    return stream.getvalue()


def check(target: Target, data: bytes) -> None:
    """Read `data`, which must end well or with an InputError of one sentence."""
    tracemalloc.reset_peak()
    try:
        target.read(data)
    except InputError as error:
        assert len(str(error)) < LONGEST_MESSAGE, 'a long message'  # noqa: PT017
        assert ' object at 0x' not in str(error), 'an address'  # noqa: PT017
    assert tracemalloc.get_traced_memory()[1] < MOST_MEMORY, 'too much memory'


def fuzz(target: Target, examples: int, number: int | None = None) -> None:
    """Check `target` with so many changed inputs; the same ones if `number` is None.

    Raises:
        Exception: whatever goes wrong, with the smallest input that hypothesis finds.
    """

    @settings(
        max_examples=examples,
        derandomize=number is None,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.integers(0, 50), st.integers(0, 50), changes(), st.booleans())
    def run(which: int, part: int, edits: list[tuple[float, int, bytes]], inside: bool) -> None:  # noqa: FBT001
        good = target.seeds[which % len(target.seeds)]
        if target.archive and inside:
            check(target, change_archive(good, edits, part))
        else:
            check(target, change_bytes(good, edits))

    act: Callable[[], None] = run if number is None else seed(number)(run)
    tracemalloc.start()
    try:
        act()
    finally:
        tracemalloc.stop()


def _hang(_number: int, _frame: object) -> None:
    msg = f'a batch took longer than {MOST_SECONDS} s for an input'
    raise TimeoutError(msg)


def main() -> int:
    """Fuzz each target for some minutes; return 1 if something is found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--minutes', type=float, default=10.0, help='for each (%(default)s)')
    parser.add_argument('--only', nargs='+', metavar='TARGET', help='only these targets')
    parser.add_argument('--seed', type=int, default=0, help='the first seed (%(default)s)')
    arguments = parser.parse_args()
    signal.signal(signal.SIGALRM, _hang)
    findings = 0
    for name, target in targets().items():
        if arguments.only and name not in arguments.only:
            continue
        for data in target.seeds:
            target.read(data)  # compiles the kernels, which may take longer than an input may
        watched = target._replace(read=_watched(target.read))
        end, batch, number = time.monotonic() + 60 * arguments.minutes, 100, arguments.seed
        while time.monotonic() < end:
            try:
                fuzz(watched, batch, number)
            except Exception as error:  # noqa: BLE001 - all are findings
                findings += 1
                notes = '\n'.join(getattr(error, '__notes__', []))
                print(f'{name}, seed {number}: {type(error).__name__}: {error}\n{notes}')  # noqa: T201
                break
            number += 1
        print(f'{name}: {batch * (number - arguments.seed)} inputs', flush=True)  # noqa: T201
    return int(findings > 0)


def _watched(read: Callable[[bytes], object]) -> Callable[[bytes], object]:
    def act(data: bytes) -> None:
        signal.alarm(MOST_SECONDS)
        try:
            read(data)
        finally:
            signal.alarm(0)

    return act


if __name__ == '__main__':
    sys.exit(main())
