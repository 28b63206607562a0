"""What a measurement of time was made on."""

import os
import platform
from pathlib import Path

import numba
import numpy as np

from lsc_pose_ros import __version__

_PROCESSORS = Path('/proc/cpuinfo')


def describe_machine() -> dict[str, object]:
    """Return the processor's model, how many cores there are, and the architecture."""
    return {
        'processor': _processor(),
        'cores': os.cpu_count() or 1,
        'architecture': platform.machine(),
    }


def versions() -> dict[str, str]:
    """Return the versions of all that has a part in how fast the kernels are."""
    return {
        'lsc_pose_ros': __version__,
        'python': platform.python_version(),
        'numpy': np.__version__,
        'numba': numba.__version__,
    }


def _processor() -> str:
    try:
        lines = _PROCESSORS.read_text(encoding='utf-8', errors='replace').splitlines()
    except OSError:  # only Linux has it
        lines = []
    for line in lines:
        name, _, value = line.partition(':')
        if name.strip() == 'model name':
            return value.strip()
    return platform.processor() or 'unknown processor'
