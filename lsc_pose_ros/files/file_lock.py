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

"""Locks of files, which the system releases when the process ends, however it ends."""

import os
import sys
from pathlib import Path

if sys.platform != 'win32':
    import fcntl


def lock_file(descriptor: int) -> bool:
    """Take the lock of an open file, which one process at a time can have.

    Returns:
        Whether the system and the file system have locks; without, nothing is locked.

    Raises:
        BlockingIOError: another process has it.
    """
    if sys.platform == 'win32':
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise
    except OSError:  # not every network file system can lock
        return False
    return True


def is_at(path: Path, descriptor: int) -> bool:
    """Return whether `path` still names an open file, which nobody has deleted or replaced."""
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except OSError:
        return False
