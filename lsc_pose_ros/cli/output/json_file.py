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

"""Writes results as JSON files for other programs."""

import json
import math
from pathlib import Path

from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import write_output


def write_json(path: Path, results: dict[str, object]) -> None:
    """Write `results` to `path`, `-` for standard output; NaN and infinity become null.

    Raises:
        InputError: the file cannot be written.
    """
    write_output(path, JSON, (json.dumps(_plain(results), indent=2) + '\n').encode())


def _plain(value: object) -> object:
    """Return `value` with None for numbers that JSON (RFC 8259) cannot represent."""
    if isinstance(value, dict):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
