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

"""A hash of all the source code that a module's kernels are compiled from."""

import hashlib
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

_CONSTANTS = (bool, int, float, complex, str, np.generic)


@cache
def source_hash(name: str) -> str:
    """Return a hash of the module `name` and of all modules of its package that it uses.

    A module uses another one if it holds that module, or a class or function of it, directly or
    through further modules. A constant does not say where it comes from, so its value is hashed.
    """
    digest = hashlib.sha256()
    for used in sorted(_used_by(name)):
        module = sys.modules[used]
        constants = {key: value for key, value in vars(module).items() if _is_constant(key, value)}
        digest.update(Path(str(module.__file__)).read_bytes())
        digest.update(repr(constants).encode())
    return digest.hexdigest()


def _used_by(name: str) -> set[str]:
    package = name.partition('.')[0]
    used: set[str] = set()
    waiting = [name]
    while waiting:
        module = waiting.pop()
        if module not in used and module.partition('.')[0] == package:
            used.add(module)
            waiting += _used_directly(sys.modules[module])
    return used


def _used_directly(module: ModuleType) -> Iterator[str]:
    for value in vars(module).values():
        if not isinstance(value, ModuleType):
            yield str(getattr(value, '__module__', ''))
        elif not hasattr(module, '__path__'):  # a package holds all its imported submodules
            yield value.__name__


def _is_constant(name: str, value: object) -> bool:
    if isinstance(value, tuple):
        return all(_is_constant(name, part) for part in value)
    # Names with two underscores, such as __file__, differ between installations.
    return not name.startswith('__') and isinstance(value, _CONSTANTS)
