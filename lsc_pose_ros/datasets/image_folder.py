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

"""Imports a folder of depth images: 16-bit PNG files, and the intrinsics of the camera as JSON."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import LATEST, regular_stamps
from lsc_pose_ros.resources.json_files import read_json

FRAME_ID = 'camera_depth_optical_frame'
_SECOND = 1_000_000_000

# Images without stamps begin at this time (2015-01-01), so that each import gives the same file.
EPOCH = 1_420_070_400 * _SECOND

# Numbers in file names from here on are stamps: of the year 2001 and later.
_LEAST_SECONDS = 1_000_000_000

_FORMS = (
    '{"fx": ..., "fy": ..., "cx": ..., "cy": ...}, {"K": [9 numbers, row by row]}, or '
    '{"intrinsic_matrix": [9 numbers, column by column]} as Open3D writes it'
)


class ImageFolder(NamedTuple):
    """A folder of depth images.

    Attributes:
        paths: the images, in the order of their stamps or names.
        camera: the intrinsics.
        masks: the folder of the masks, which have the names of the images; None without masks.
        scale: metres per unit of a pixel.
        rate: images per second, if their names are no stamps.
    """

    paths: Sequence[Path]
    camera: Intrinsics
    masks: Path | None
    scale: float
    rate: float

    @property
    def stamps(self) -> list[int]:
        """The stamp of each image, nanoseconds: from the names, or else from the rate."""
        named = _stamps_in(self.paths)
        if named:
            return named
        folder, count = self.paths[0].parent, len(self.paths)
        return [int(stamp) for stamp in regular_stamps(folder, EPOCH, count, 1 / self.rate)]


def open_image_folder(
    directory: Path, intrinsics: Path | None, masks: Path | None, scale: float, rate: float
) -> ImageFolder:
    """Find the images of a folder and read the intrinsics.

    Args:
        directory: the folder of the images.
        intrinsics: the JSON file; None: the only one in the folder.
        masks: the folder of the masks, None without masks.
        scale: metres per unit of a pixel.
        rate: images per second, if their names are no stamps.

    Raises:
        InputError: there are no images, or the intrinsics cannot be read.
    """
    if not directory.is_dir():
        msg = f'there is no folder {directory}; give the folder of the depth images'
        raise InputError(msg)
    paths = sorted(directory.glob('*.png'), key=lambda path: _natural(path.name))
    stamps = _stamps_in(paths)
    paths = [path for _, path in sorted(zip(stamps, paths, strict=True))] if stamps else paths
    if not paths:
        msg = f'{directory} has no .png files; give the folder of the depth images'
        raise InputError(msg)
    if intrinsics is None:
        found = sorted(directory.glob('*.json'))
        if len(found) != 1:
            msg = f'{directory} has {len(found)} .json files; name one with --intrinsics'
            raise InputError(msg)
        intrinsics = found[0]
    return ImageFolder(paths, read_intrinsics(intrinsics), masks, scale, rate)


def image_frames(folder: ImageFolder) -> Iterator[Frame]:
    """Yield the frames of a folder.

    Raises:
        InputError: an image cannot be read, or has another size than the others.
    """
    size: tuple[int, ...] | None = None
    for path, stamp in zip(folder.paths, folder.stamps, strict=True):
        pixels = read_png(path)
        if pixels.dtype == np.uint8:
            msg = f'{path} has 8 bits per pixel; depth images need 16'
            raise InputError(msg)
        if size not in {None, pixels.shape}:
            msg = f'{path} has the size {pixels.shape}, the image before it {size}'
            raise InputError(msg)
        size = pixels.shape
        labels = np.full(pixels.shape, NO_BODY, np.int32)
        if folder.masks is not None:
            labels = _read_mask(folder.masks / path.name, pixels.shape)
        depth = (pixels * folder.scale).astype(np.float32)
        yield Frame(stamp, FRAME_ID, depth, labels, folder.camera, None)


def read_intrinsics(path: Path) -> Intrinsics:
    """Return the intrinsics in a JSON file.

    Raises:
        InputError: the file cannot be read, or has no intrinsics.
    """
    table = read_json(path, 'intrinsics')
    try:
        return Intrinsics.from_matrix(_matrix(table))
    except (KeyError, TypeError, ValueError, OverflowError, InputError) as error:
        why = excerpt(error)
        msg = f'{path} has no intrinsics ({why}); it must have one of the forms {_FORMS}'
        raise InputError(msg) from error


def _matrix(table: Any) -> NDArray[np.float64]:  # noqa: ANN401 - anything that JSON holds
    if not isinstance(table, dict):
        msg = 'it is no table'
        raise TypeError(msg)
    if 'intrinsic_matrix' in table:
        return np.array(table['intrinsic_matrix'], np.float64).reshape(3, 3).T
    if 'K' in table or 'k' in table:
        return np.array(table.get('K', table.get('k')), np.float64).reshape(3, 3)
    fx, fy, cx, cy = (float(table[name]) for name in ('fx', 'fy', 'cx', 'cy'))
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


def _read_mask(path: Path, size: tuple[int, ...]) -> NDArray[np.int32]:
    mask = read_png(path)
    if mask.shape != size:
        msg = f'the mask {path} has the size {mask.shape}, its image {size}'
        raise InputError(msg)
    return np.where(mask > 0, mask.astype(np.int32), NO_BODY)


def read_png(path: Path) -> NDArray[Any]:
    """Return the pixels of a PNG file with one channel, shape (H, W).

    Raises:
        InputError: it cannot be read, or has several channels.
    """
    try:
        with Image.open(path) as image:
            pixels = np.array(image)
    except Exception as error:  # a damaged file raises exceptions of many types
        msg = f'cannot read the image {path}: {error}'
        raise InputError(msg) from error
    if pixels.ndim != 2:
        msg = f'{path} is a colour image; depth images and masks have one channel'
        raise InputError(msg)
    # Some versions of Pillow read 16 bits as 32.
    return pixels.astype(np.uint16) if pixels.dtype == np.int32 else pixels


def _stamps_in(paths: Sequence[Path]) -> list[int]:
    """Return the stamps in the names of files, empty if not each of them has another one."""
    stamps = [stamp for path in paths if (stamp := _stamp_in(path.stem)) is not None]
    return stamps if len(set(stamps)) == len(paths) else []


def _stamp_in(name: str) -> int | None:
    """Return the stamp that a file's name consists of: seconds with decimals, or nanoseconds."""
    match = re.search(r'(\d{10,})(?:\.(\d{1,9}))?$', name)
    if match is None:
        return None
    whole, decimals = int(match.group(1)), (match.group(2) or '').ljust(9, '0')
    if _LEAST_SECONDS <= whole <= LATEST // _SECOND:
        return whole * _SECOND + int(decimals)
    return whole if _LEAST_SECONDS * _SECOND <= whole <= LATEST else None


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts `image_9` before `image_10`."""
    return [(int(part) if part.isdigit() else -1, part) for part in re.split(r'(\d+)', name)]
