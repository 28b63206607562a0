"""The progress bar of the long commands."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

_Item = TypeVar('_Item')


def progress(iterable: Iterable[_Item], total: int | None, description: str) -> Iterator[_Item]:
    """Yield the items of `iterable`; on a terminal, draw a bar on stderr meanwhile.

    Args:
        iterable: what is worked through.
        total: how many items it has, where that is known.
        description: what stands before the bar.
    """
    # `disable=None` is tqdm's word for: only on a terminal.
    yield from tqdm(iterable, desc=description, total=total, file=sys.stderr, disable=None)
