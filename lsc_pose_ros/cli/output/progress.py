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

"""Progress bars for long commands."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

_Item = TypeVar('_Item')


def progress(iterable: Iterable[_Item], total: int | None, description: str) -> Iterator[_Item]:
    """Yield the items of `iterable`, with a progress bar on stderr if it is a terminal.

    Args:
        iterable: the items.
        total: the number of items, None if it is unknown.
        description: the text before the bar.
    """
    # With `disable=None`, tqdm draws only on a terminal.
    yield from tqdm(iterable, desc=description, total=total, file=sys.stderr, disable=None)
