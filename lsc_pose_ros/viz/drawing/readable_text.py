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

"""Texts that any page and picture can show."""


def readable(text: str) -> str:
    """Return `text` with a question mark for each byte of a file's name that is no text.

    Python holds such a byte as a lone surrogate, which neither UTF-8 nor a font has.
    """
    return text.encode('utf-8', 'replace').decode('utf-8')
