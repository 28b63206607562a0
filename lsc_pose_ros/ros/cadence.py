"""How regularly stamps come, and how many are missing between them; no ROS in here."""

from collections import deque

# So many steps say what the period is; fewer do not.
_ENOUGH = 10
_REMEMBERED = 60

# Where frames are lost at random, this share of the steps is still one period long.
_SHARE_OF_SINGLE_STEPS = 0.25

# A pause this long is one: somebody stopped the camera. Nanoseconds.
_PAUSE = 2_000_000_000


class Cadence:
    """Finds the period of a stream from its stamps, and counts the frames that must be missing.

    The period is the lower quartile of the last steps from stamp to stamp: their median is right
    only while less than half of the frames are lost.

    Attributes:
        missing: how many frames are missing.
    """

    def __init__(self) -> None:
        """Start with nothing."""
        self.missing = 0
        self._last: int | None = None
        self._steps: deque[int] = deque(maxlen=_REMEMBERED)

    @property
    def period(self) -> int | None:
        """Nanoseconds from frame to frame, None while it is not known."""
        if len(self._steps) < _ENOUGH:
            return None
        return sorted(self._steps)[int(_SHARE_OF_SINGLE_STEPS * len(self._steps))]

    def add(self, stamp: int) -> None:
        """Take the next stamp, nanoseconds, newer than all before."""
        if self._last is not None:
            step = stamp - self._last
            if step < _PAUSE:
                self._count(step)
        self._last = stamp

    def restart(self) -> None:
        """Forget the stamps, for the next one does not follow them."""
        self._last = None
        self._steps.clear()

    def _count(self, step: int) -> None:
        self._steps.append(step)
        period = self.period
        if period is not None:
            self.missing += max(round(step / period) - 1, 0)
