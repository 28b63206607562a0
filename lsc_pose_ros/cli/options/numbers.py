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

"""Numbers that stand on the command line, refused with a reason where they make no sense."""

import argparse
import math
from collections.abc import Callable

SCALES = (1e-9, 1e9)
"""The smallest and the largest scale of a file, metres per unit."""


def positive_int(word: str) -> int:
    """Return the whole number above 0 that `word` stands for.

    Raises:
        ArgumentTypeError: it is none.
    """
    try:
        value = int(word)
    except ValueError:
        value = 0
    if value < 1:
        msg = f'{word!r} is not a whole number above 0'
        raise argparse.ArgumentTypeError(msg)
    return value


def number_between(kind: type, lowest: float, highest: float) -> Callable[[str], int | float]:
    """Return what converts a word to a number from `lowest` to `highest`.

    Args:
        kind: int or float.
        lowest: the smallest number that is accepted.
        highest: the largest number that is accepted.
    """

    def convert(word: str) -> int | float:
        try:
            value = int(word) if kind is int else float(word)
        except ValueError:
            value = math.nan
        if not lowest <= value <= highest:  # NaN, too
            noun = 'whole number' if kind is int else 'number'
            msg = f'{word!r} is not a {noun} from {lowest} to {highest}'
            raise argparse.ArgumentTypeError(msg)
        return value

    return convert


def finite_float(word: str) -> float:
    """Return the finite number that `word` stands for, NaN where it is none."""
    try:
        value = float(word)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def positive_float(word: str) -> float:
    """Return the finite number above 0 that `word` stands for.

    Raises:
        ArgumentTypeError: it is none.
    """
    value = finite_float(word)
    if not value > 0:  # NaN, too
        msg = f'{word!r} is not a number above 0'
        raise argparse.ArgumentTypeError(msg)
    return value


def float_from_zero(word: str) -> float:
    """Return the finite number, 0 or above, that `word` stands for.

    Raises:
        ArgumentTypeError: it is none.
    """
    value = finite_float(word)
    if not value >= 0:  # NaN, too
        msg = f'{word!r} is not a number from 0'
        raise argparse.ArgumentTypeError(msg)
    return value
