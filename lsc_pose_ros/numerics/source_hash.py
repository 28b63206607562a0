"""A stamp of all the source code that the machine code of a module's kernels is made from."""

import hashlib
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np


@cache
def source_stamp(name: str) -> str:
    """Return a hash of the module `name` and of all that it uses of its package, near or far.

    A module uses another one where it holds the module itself, or a class or function of it. A
    constant does not tell where it comes from, so its value counts.
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
        elif not hasattr(module, '__path__'):  # a package holds what anybody has imported of it
            yield value.__name__


def _is_constant(name: str, value: object) -> bool:
    if isinstance(value, tuple):
        return all(_is_constant(name, part) for part in value)
    # Where a module lies, for one, has two underscores.
    return not name.startswith('__') and isinstance(value, _CONSTANTS)


_CONSTANTS = (bool, int, float, complex, str, np.generic)
