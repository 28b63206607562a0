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

"""The exception for inputs that cannot be used, and how its message quotes them."""

LONGEST_TEXT = 2000
"""The longest text that is logged or printed, characters; a longer one loses its middle."""


class InputError(Exception):
    """A file, topic, parameter or argument cannot be used.

    The message is one sentence that names the input and says what to do. The command line prints
    it and ends with status 2; the node logs it.
    """


def excerpt(value: object, length: int = 80) -> str:
    """Return the text of `value`, cut, for a message: in files it may be megabytes long."""
    text = ' '.join(str(value).split())
    return text if len(text) <= length else f'{text[: length - 3]}...'


def cut(text: str) -> str:
    """Return `text`, which may quote what others have sent, without its middle if it is long."""
    if len(text) <= LONGEST_TEXT:
        return text
    half = LONGEST_TEXT // 2
    return f'{text[:half]} [... {len(text) - 2 * half} characters ...] {text[-half:]}'
