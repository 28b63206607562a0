"""A depth image with its label image."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class DepthImage(NamedTuple):
    """A depth image with the bodies that its pixels show.

    Attributes:
        depth: metres, 0 if the pixel shows nothing, shape (H, W), float32.
        labels: the body that a pixel shows, or NO_BODY, shape (H, W), int32.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
