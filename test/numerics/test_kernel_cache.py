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

"""The cache of machine code; separate processes run small kernels of an installation."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import PATIENCE, wait_until

import lsc_pose_ros

# A kernel that calls one in another file, which imports a constant from a third.
CONSTANTS = 'FACTOR = 2.0\n'
INNER = """
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.numerics.constants import FACTOR

@kernel
def scale(x):
    return x * FACTOR
"""
OUTER = """
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.numerics.inner import scale

@kernel
def outer(x):
    return scale(x) + 1
"""
CALL = """
from lsc_pose_ros.numerics.outer import outer
print(outer(1.5), sum(outer.stats.cache_hits.values()))
"""
DESCRIBE = """
from lsc_pose_ros.numerics.kernel_cache import cache_directory, describe_cache
print(cache_directory(), describe_cache(), sep='\\n')
"""


class Installation:
    """The numerics of the package with three more modules, installed in a separate folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.numerics = folder / 'lsc_pose_ros' / 'numerics'
        self.user = folder / 'home' / 'cache'
        source = Path(lsc_pose_ros.__file__).parent
        shutil.copytree(
            source / 'numerics', self.numerics, ignore=shutil.ignore_patterns('__pycache__')
        )
        for name in ('__init__.py', 'errors.py'):
            shutil.copy(source / name, self.numerics.parent)
        self.write('constants', CONSTANTS)
        self.write('inner', INNER)
        self.write('outer', OUTER)

    def write(self, module: str, text: str) -> None:
        (self.numerics / f'{module}.py').write_text(text)

    def make_read_only(self) -> None:
        """Block the cache beside the sources with a file; permissions would not stop root."""
        shutil.rmtree(self.numerics / '__pycache__', ignore_errors=True)
        (self.numerics / '__pycache__').touch()

    def make_user_read_only(self) -> None:
        self.user.parent.mkdir()
        self.user.touch()

    def start(self, code: str, **variables: str) -> subprocess.Popen[str]:
        environment = {
            **{name: value for name, value in os.environ.items() if 'NUMBA' not in name},
            'PYTHONDONTWRITEBYTECODE': '1',
            'XDG_CACHE_HOME': str(self.user),
            **variables,
        }
        return subprocess.Popen(
            [sys.executable, '-c', code],
            cwd=self.folder,  # where `python -c` looks for modules first
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, code: str, **variables: str) -> list[str]:
        program = self.start(code, **variables)
        output, errors = program.communicate(timeout=PATIENCE)
        assert program.returncode == 0, errors
        assert errors == ''
        return output.splitlines()

    def call(self, **variables: str) -> tuple[float, int]:
        """Return the result of `outer(1.5)` in a new process, and its number of cache hits."""
        result, hits = self.run(CALL, **variables)[-1].split()
        return float(result), int(hits)


@pytest.fixture
def installation(tmp_path: Path) -> Installation:
    return Installation(tmp_path)


def test_code_is_cached_beside_the_sources(installation: Installation) -> None:
    assert installation.call() == (4.0, 0)
    assert installation.call() == (4.0, 1)
    directory = installation.numerics / '__pycache__'
    assert list(directory.glob('outer.outer-*.nbc'))
    assert installation.run(DESCRIBE) == [str(directory), f'kept in {directory}']
    assert not installation.user.exists()


def test_read_only_installation_falls_back_to_the_users_cache(installation: Installation) -> None:
    installation.make_read_only()
    assert installation.call() == (4.0, 0)
    assert installation.call() == (4.0, 1)
    directory, text = installation.run(DESCRIBE)
    assert Path(directory).is_relative_to(installation.user)
    assert list(Path(directory).glob('outer.outer-*.nbc'))
    assert text == f'kept in {directory}, because the installation is read-only'


def test_kernels_work_if_no_folder_can_be_written(installation: Installation) -> None:
    installation.make_read_only()
    installation.make_user_read_only()
    assert installation.call() == (4.0, 0)
    assert installation.call() == (4.0, 0)
    directory, text = installation.run(DESCRIBE)
    assert directory == 'None'
    assert text.startswith('not kept')
    assert 'NUMBA_CACHE_DIR' in text


def test_named_folder_comes_first(installation: Installation, tmp_path: Path) -> None:
    named = str(tmp_path / 'named')
    assert installation.call(NUMBA_CACHE_DIR=named) == (4.0, 0)
    assert installation.call(NUMBA_CACHE_DIR=named) == (4.0, 1)
    directory, text = installation.run(DESCRIBE, NUMBA_CACHE_DIR=named)
    assert Path(directory).is_relative_to(named)
    assert text == f'kept in {directory}'
    assert not (installation.numerics / '__pycache__').exists()


@pytest.mark.parametrize(
    ('module', 'text'),
    [('inner', INNER.replace('x *', '2 * x *')), ('constants', 'FACTOR = 4.0\n')],
)
def test_change_in_a_used_file_recompiles_the_kernel(
    installation: Installation, module: str, text: str
) -> None:
    assert installation.call() == (4.0, 0)
    installation.write(module, text)
    assert installation.call() == (7.0, 0)
    assert installation.call() == (7.0, 1)


def test_change_in_an_unused_file_keeps_the_cache(installation: Installation) -> None:
    assert installation.call() == (4.0, 0)
    installation.write('frame', '')
    assert installation.call() == (4.0, 1)


def test_code_with_checks_of_indices_is_kept_apart(installation: Installation) -> None:
    installation.write('outer', OUTER.replace('scale(x) + 1', 'np.ones(1)[int(x) + 5]'))
    text = (installation.numerics / 'outer.py').read_text()
    installation.write('outer', f'import numpy as np\n{text}')
    installation.call()  # reads what happens to be there
    code = f'try:\n    {CALL.strip().splitlines()[0]}\n    outer(1.5)\n'
    code += 'except IndexError:\n    print("checked")\nelse:\n    print("not checked")'
    assert installation.run(code) == ['not checked']
    assert installation.run(code, NUMBA_BOUNDSCHECK='1') == ['checked']
    assert installation.run(code) == ['not checked']
    assert installation.run(code, NUMBA_BOUNDSCHECK='1') == ['checked']


def truncate(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def zero(file: Path) -> None:
    file.write_bytes(bytes(file.stat().st_size))


def test_damaged_file_is_replaced(installation: Installation) -> None:
    assert installation.call() == (4.0, 0)
    for kind in ('nbi', 'nbc'):
        for damage in (truncate, zero):
            for file in (installation.numerics / '__pycache__').glob(f'*.{kind}'):
                damage(file)
            assert installation.call() == (4.0, 0)
    assert installation.call() == (4.0, 1)


def test_kernels_work_with_a_full_disk(installation: Installation) -> None:
    fill = """
import errno
from numba.core.caching import IndexDataCacheFile

def fail(self, path):
    raise OSError(errno.ENOSPC, 'No space left on device', path)

IndexDataCacheFile._open_for_write = fail
"""
    assert installation.run(fill + CALL) == ['4.0 0']
    assert installation.call() == (4.0, 0)


def test_kernels_work_if_the_folder_is_deleted(installation: Installation) -> None:
    vanish = f"""
import shutil
import lsc_pose_ros.numerics.outer
shutil.rmtree({str(installation.numerics / '__pycache__')!r})
"""
    assert installation.run(vanish + CALL) == ['4.0 0']


def test_two_processes_can_compile_at_once(
    installation: Installation,
) -> None:
    call = """
import numpy as np
from lsc_pose_ros.numerics.outer import outer

kinds = ['i1', 'i2', 'i4', 'i8', 'u1', 'u2', 'u4', 'u8', 'f4', 'f8', 'c8', 'c16']
for kind in kinds[{chosen}]:
    assert (outer(np.ones(3, kind)) == 3).all(), kind
print(len(outer.stats.cache_hits), len(outer.stats.cache_misses))
"""
    both = [installation.start(call.format(chosen=chosen)) for chosen in ('::2', '1::2')]
    for program in both:
        output, errors = program.communicate(timeout=PATIENCE)
        assert program.returncode == 0, errors
        assert output.split() == ['0', '6']
    assert installation.run(call.format(chosen=':')) == ['12 0']


# Stops while it saves the code of `outer`, until it is sent a line.
PAUSE = """
from numba.core.caching import IndexDataCacheFile

save_index = IndexDataCacheFile._save_index

def pause(self, overloads):
    if self._index_name.startswith('outer.'):
        print('saving', flush=True)
        input()
    save_index(self, overloads)

IndexDataCacheFile._save_index = pause
"""
LOCKS = Path('/proc/locks')


def waits_for_a_lock(pid: int) -> bool:
    lines = LOCKS.read_text().splitlines()
    return any('->' in line and str(pid) in line.split() for line in lines)


@pytest.mark.skipif(not LOCKS.exists(), reason=f'there is no {LOCKS}')
def test_process_waits_while_another_one_saves(installation: Installation) -> None:
    """Without the lock, the index of the first would replace that of the second."""
    call = CALL.replace('outer(1.5)', 'outer({value})')
    first = installation.start(PAUSE + call.format(value='1.5'))
    assert first.stdout is not None
    assert first.stdout.readline() == 'saving\n'
    second = installation.start(call.format(value='1'))
    assert wait_until(lambda: second.poll() is not None or waits_for_a_lock(second.pid))
    for program in (first, second):
        _, errors = program.communicate('\n', timeout=PATIENCE)
        assert program.returncode == 0, errors
    for value in ('1.5', '1'):
        assert installation.run(call.format(value=value))[-1].split()[1] == '1'


# Hides parts of numba's caching module while this package is imported, as if its version of numba
# had other ones. Numba itself needs them later.
REPLACE = """
import sys
import types
from numba.core import caching

class FunctionCache:
    def __init__(self, function):
        self.cache_path = '/'

other = types.ModuleType('numba.core.caching')
{parts}
sys.modules['numba.core.caching'] = other
import lsc_pose_ros.numerics.kernel_cache
sys.modules['numba.core.caching'] = caching
"""
RENAMED = REPLACE.format(parts='')
REBUILT = REPLACE.format(
    parts="""
other.FunctionCache = FunctionCache
other.IndexDataCacheFile = caching.IndexDataCacheFile
"""
)


@pytest.mark.parametrize('numba', [RENAMED, REBUILT], ids=['renamed', 'rebuilt'])
def test_numbas_own_cache_is_used_if_its_parts_are_unknown(
    installation: Installation, numba: str
) -> None:
    assert installation.run(numba + CALL) == ['4.0 0']
    assert installation.run(numba + CALL) == ['4.0 1']
    directory, text = installation.run(numba + DESCRIBE)
    assert Path(directory) == installation.numerics / '__pycache__'
    assert text == f'kept in {directory}'


def test_kernels_run_interpreted(installation: Installation) -> None:
    call = 'from lsc_pose_ros.numerics.outer import outer; print(outer(1.5))'
    assert installation.run(call, NUMBA_DISABLE_JIT='1') == ['4.0']
    assert installation.run(DESCRIBE, NUMBA_DISABLE_JIT='1')[0] == 'None'
