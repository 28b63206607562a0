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

"""Names of files that stand beside another file, such as its checkpoint."""

import hashlib
import os
from pathlib import Path

from lsc_pose_ros.errors import InputError

_LONGEST_NAME = 255
"""The longest name that file systems allow, bytes; some allow less."""


def sibling(path: Path, suffix: str, prefix: str = '') -> Path:
    """Return the file `prefix` NAME `suffix` beside `path`, whose name is NAME.

    If that is longer than the file system allows, the end of NAME is replaced by its hash, so
    that each file has a sibling of its own.

    Raises:
        InputError: `path` has no name: it is a folder.
    """
    if not path.name:
        msg = f'{path} is a folder; choose another name'
        raise InputError(msg)
    longest = longest_name(path.parent)
    name = os.fsencode(path.name)
    added = len(os.fsencode(prefix + suffix))
    if len(name) + added <= longest:
        return path.with_name(f'{prefix}{path.name}{suffix}')
    mark = hashlib.sha256(name).hexdigest()[:16]
    # A character that is cut in the middle is left out.
    stem = name[: longest - added - len(mark) - 1].decode(errors='ignore')
    return path.with_name(f'{prefix}{stem}~{mark}{suffix}')


def longest_name(folder: Path) -> int:
    """Return the longest name of a file in `folder`, bytes."""
    try:
        known = os.pathconf(folder, 'PC_NAME_MAX')
    except (AttributeError, OSError, ValueError):  # no such folder yet, or not this system
        return _LONGEST_NAME
    return min(known, _LONGEST_NAME) if known > 0 else _LONGEST_NAME
