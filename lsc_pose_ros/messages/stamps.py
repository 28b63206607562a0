"""Stamps of messages as integers, nanoseconds."""

from typing import Protocol

NANOSECONDS = 1_000_000_000
"""Nanoseconds per second."""


class Time(Protocol):
    """A builtin_interfaces/Time of any ROS library."""

    sec: int
    nanosec: int


def nanoseconds(time: Time) -> int:
    """Return `time` in nanoseconds."""
    return int(time.sec) * NANOSECONDS + int(time.nanosec)


def sec_nanosec(stamp: int) -> tuple[int, int]:
    """Return the fields `sec` and `nanosec` of `stamp`, nanoseconds."""
    return divmod(int(stamp), NANOSECONDS)
