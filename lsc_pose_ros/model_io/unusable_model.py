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

"""The exception for model files whose content cannot be used, and what others say of them."""

import re

_ADDRESS = re.compile(r' at 0x[0-9a-fA-F]+')


class UnusableModelError(ValueError):
    """A part of a model is wrong; the message says which, and is put in brackets."""


def why_unusable(error: Exception) -> str:
    """Return what an error says of a file, cut, and without addresses in memory."""
    return _ADDRESS.sub('', str(error) or type(error).__name__)[:200]
