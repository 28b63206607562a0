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

"""The exceptions that damaged files cause, and their descriptions."""

import sqlite3
import struct
import zlib

import yaml
import zstandard
from mcap.exceptions import EndOfFile, McapError, RecordLengthLimitExceeded
from mcap.stream_reader import CRCValidationError
from rosbags.serde import SerdeError

from lsc_pose_ros.errors import excerpt

# mcap, rosbags and lz4 do not catch the exceptions that damaged data cause in the Python code
# below them.
DAMAGE = (
    McapError,
    SerdeError,
    zstandard.ZstdError,
    sqlite3.Error,
    struct.error,
    zlib.error,
    yaml.YAMLError,
    OSError,
    ValueError,
    TypeError,
    LookupError,
    AttributeError,
    ArithmeticError,
    AssertionError,
    EOFError,
    MemoryError,
    RuntimeError,
)


def reason(error: BaseException) -> str:
    """Return a short description of `error` for the user."""
    if isinstance(error, CRCValidationError):
        return 'a checksum is wrong'
    if isinstance(error, EndOfFile | EOFError | struct.error):
        return 'the file is cut off'
    if isinstance(error, RecordLengthLimitExceeded | MemoryError):
        return 'a length is impossible'
    if isinstance(error, OSError) and error.strerror:
        return error.strerror.lower()
    return excerpt(str(error) or type(error).__name__, 100)
