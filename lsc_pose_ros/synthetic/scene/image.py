"""A depth image and its mask."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Image(NamedTuple):
    """What the camera sees.

    Attributes:
        depth: metres, 0 where there is nothing, shape (H, W), float32.
        labels: the body that a pixel shows, or NO_BODY, shape (H, W), int32.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
