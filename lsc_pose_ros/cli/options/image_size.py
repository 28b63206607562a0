"""Image sizes on the command line."""

import argparse
import re


def image_size(word: str) -> tuple[int, int]:
    """Return the width and the height that a word like 320x240 gives.

    Raises:
        ArgumentTypeError: it gives none.
    """
    match = re.fullmatch(r'(\d+)x(\d+)', word)
    if match is None:
        msg = f'{word!r} is no size; write it as 320x240'
        raise argparse.ArgumentTypeError(msg)
    return int(match[1]), int(match[2])
