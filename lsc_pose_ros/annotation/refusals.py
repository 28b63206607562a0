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
"""Why a change of a page is not kept."""

from enum import Enum

from lsc_pose_ros.errors import InputError


class Reason(Enum):
    """Why a change is not kept."""

    STALE = 'another page has changed the frame meanwhile'
    BEING_WRITTEN = 'the recording is being written'
    ENDED = 'the annotation has ended'
    NO_STORAGE = 'the journal cannot be written'


class RefusedError(InputError):
    """A change is sound, but is not kept.

    Attributes:
        reason: why.
    """

    def __init__(self, message: str, reason: Reason) -> None:
        """Say in one sentence what is not kept, and what to do."""
        super().__init__(message)
        self.reason = reason
