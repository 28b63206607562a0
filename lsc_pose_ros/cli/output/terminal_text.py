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

"""Texts for the terminal: those of strangers are cut, and cannot control it."""

from lsc_pose_ros.errors import cut, excerpt

_LONGEST_NAME = 100


def line_of(text: object) -> str:
    r"""Return `text`, which may quote what others have written, as one line for the terminal.

    Control characters become escapes such as \x1b, and of a very long text the middle is left
    out.
    """
    return ''.join(map(_printable, cut(' '.join(str(text).split()))))


def name_of(text: object) -> str:
    """Return a name that others have given, such as a topic or a frame, cut to fit in a line."""
    return line_of(excerpt(text, _LONGEST_NAME))


def _printable(character: str) -> str:
    # A lone surrogate stands for a byte that is no text; the stream escapes what it cannot show.
    if character.isprintable() or '\ud800' <= character <= '\udfff':
        return character
    return character.encode('unicode_escape').decode('ascii')
