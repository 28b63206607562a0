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

"""The header of an archive of arrays: its format, its version, and what else it says, as JSON."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.model_io.model_file import read_array
from lsc_pose_ros.model_io.unusable_model import UnusableModelError


def header_array(kind: str, version: int, content: Mapping[str, object]) -> NDArray[np.uint8]:
    """Return a header as the bytes of its JSON text, shape (bytes,)."""
    header = {'format': kind, 'version': version, **content}
    return np.frombuffer(json.dumps(header).encode(), np.uint8)


def read_header(archive: Any, kind: str, version: int) -> dict[str, Any]:  # noqa: ANN401
    """Return what the header of an open archive says.

    Args:
        archive: what `numpy.load` returns.
        kind: the format that it must have.
        version: the only version that is read.

    Raises:
        UnusableModelError: it is of another format or version.
        ValueError: it is no JSON text.
    """
    header = json.loads(read_array(archive, 'header', (np.uint8, 1)).tobytes())
    if not isinstance(header, dict) or header.get('format') != kind:
        msg = 'its header is of another kind of file'
        raise UnusableModelError(msg)
    if header.get('version') != version:
        msg = f'it has version {header.get("version")!r:.20}; this package reads {version}'
        raise UnusableModelError(msg)
    return header
