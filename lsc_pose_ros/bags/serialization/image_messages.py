"""Image messages, raw or compressed, to metres and to body numbers."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags.serialization.deserialize import CompressedImageMessage, ImageMessage
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import decode_compressed_depth
from lsc_pose_ros.messages.codecs.image_encodings import (
    decode_depth,
    decode_mask,
    depth_to_metres,
    label_pixels,
)
from lsc_pose_ros.messages.codecs.png import read_png


def depth_of(message: ImageMessage | CompressedImageMessage) -> NDArray[np.float32]:
    """Return the depth image in metres, shape (H, W), 0 where the sensor saw nothing.

    Raises:
        InputError: the encoding is unknown or the data do not fill the image.
    """
    if isinstance(message, ImageMessage):
        return decode_depth(message.data, message.layout)
    if 'compresseddepth' not in message.format.lower() and 'png' in message.format.lower():
        pixels = read_png(message.data.data)  # 16UC1 by the transport `compressed`
        if pixels.dtype != np.uint16:
            msg = f'the PNG depth image ({message.format}) has 8 bits; depth needs 16'
            raise InputError(msg)
        return depth_to_metres(pixels)
    return depth_to_metres(decode_compressed_depth(message.data.data, message.format))


def labels_of(
    message: ImageMessage | CompressedImageMessage, background: int
) -> NDArray[np.int32]:
    """Return the body that each pixel shows, shape (H, W), NO_BODY for none.

    Args:
        message: the mask.
        background: the pixel value that means no body.

    Raises:
        InputError: the encoding is unknown, lossy, or the data do not fill the image.
    """
    if isinstance(message, ImageMessage):
        return decode_mask(message.data, message.layout, background)
    if 'png' not in message.format.lower():
        msg = f'a mask compressed as {message.format!r} cannot be used; only PNG keeps the numbers'
        raise InputError(msg)
    return label_pixels(read_png(message.data.data), background)
