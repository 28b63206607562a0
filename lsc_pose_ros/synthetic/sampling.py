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

"""Random decisions from a fixed-length stream of uniform numbers."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

_Choice = TypeVar('_Choice')


class RandomStream:
    """Uniform random numbers that are generated in advance and consumed one by one.

    The constructor always takes the same count of numbers from its generator. So the next stream
    from that generator does not depend on the decisions that this one led to, and a difference in
    a last bit does not spread.
    """

    def __init__(self, random: np.random.Generator, count: int = 1024) -> None:
        """Generate `count` numbers with `random`."""
        self._numbers = random.random(count).tolist()
        self._next = 0

    def uniform(self) -> float:
        """Return a number that is uniform in [0, 1)."""
        self._next += 1
        return float(self._numbers[self._next - 1])

    def bernoulli(self, probability: float) -> bool:
        """Return True with a probability."""
        return self.uniform() < probability

    def between(self, low: float, high: float) -> float:
        """Return a number that is uniform in [low, high)."""
        return low + (high - low) * self.uniform()

    def normal(self, mean: float, deviation: float) -> float:
        """Return an approximately normal number, at most 3.5 deviations from the mean.

        It is the scaled sum of four uniform numbers (Irwin-Hall); the standard deviation of that
        sum is sqrt(1/3).
        """
        four = self.uniform() + self.uniform() + self.uniform() + self.uniform()
        return mean + deviation * (four - 2.0) * 3**0.5

    def choose(self, choices: Sequence[tuple[float, _Choice]]) -> _Choice:
        """Return one of `choices`, which are pairs of a weight and a value."""
        left = self.uniform() * sum(weight for weight, _ in choices)
        for weight, choice in choices:
            left -= weight
            if left < 0:
                return choice
        return choices[-1][1]
