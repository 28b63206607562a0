"""Chances of one draw, taken one after the other from numbers drawn beforehand."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

_Choice = TypeVar('_Choice')


class Chances:
    """Numbers that depend on chance alone.

    All are drawn when it is made, so whatever is decided on the way, the next draw from the same
    source begins at the same place: a difference in a last bit does not spread.
    """

    def __init__(self, random: np.random.Generator, count: int = 1024) -> None:
        """Draw `count` numbers from `random`."""
        self._numbers = random.random(count).tolist()
        self._next = 0

    def share(self) -> float:
        """Return a number, uniform in [0, 1)."""
        self._next += 1
        return float(self._numbers[self._next - 1])

    def happens(self, probability: float) -> bool:
        """Return whether what has this probability happens."""
        return self.share() < probability

    def between(self, low: float, high: float) -> float:
        """Return a number, uniform in [low, high)."""
        return low + (high - low) * self.share()

    def near(self, mean: float, deviation: float) -> float:
        """Return a number that is spread like a bell, at most 3.5 deviations off the mean.

        The sum of four uniform numbers, whose deviation is the root of 1/3.
        """
        four = self.share() + self.share() + self.share() + self.share()
        return mean + deviation * (four - 2.0) * 3**0.5

    def choose(self, choices: Sequence[tuple[float, _Choice]]) -> _Choice:
        """Return one of `choices`, each given with how often it is chosen."""
        left = self.share() * sum(often for often, _ in choices)
        for often, choice in choices:
            left -= often
            if left < 0:
                return choice
        return choices[-1][1]
