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

"""Completion of the command line in the shell, with argcomplete."""

import argparse
import os

_COMPLETING = '_ARGCOMPLETE'
_LINE = 'COMP_LINE'


def typed_words() -> list[str]:
    """Return the words after the program that the shell wants to complete, else no words."""
    if _COMPLETING not in os.environ:
        return []
    return os.environ.get(_LINE, '').split()[1:]


def complete(parser: argparse.ArgumentParser) -> None:
    """Answer the shell and end the program, if the shell wants to complete words."""
    if _COMPLETING not in os.environ:
        return
    try:
        import argcomplete  # noqa: PLC0415 - an optional dependency
    except ImportError:
        return
    argcomplete.autocomplete(parser)
