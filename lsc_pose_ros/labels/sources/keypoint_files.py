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

"""Reads keypoints in images from CSV files, COCO's results and OpenPose's files."""

import re
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import LARGEST_BODY, LATEST
from lsc_pose_ros.labels.sources.table_file import TableFormat, read_table
from lsc_pose_ros.labels.vocabulary import Vocabulary
from lsc_pose_ros.resources.json_files import read_json

LARGEST_PIXEL = 1e6
"""No image has so many columns or rows."""

KeypointsKey = tuple[str, int]
"""The image of keypoints: ('stamp', nanoseconds) or ('frame', number of the depth image)."""


class Keypoints(NamedTuple):
    """The keypoints of one body in one image.

    Attributes:
        body: its number.
        pixels: column and row of the vocabulary's joints, NaN if unknown, shape (S, 2).
    """

    body: int
    pixels: NDArray[np.float64]


def load_keypoints(
    path: Path, vocabulary: Vocabulary, start: int, minimum_confidence: float
) -> dict[KeypointsKey, list[Keypoints]]:
    """Return the keypoints of a CSV or JSON file, or of a folder of OpenPose's JSON files.

    Args:
        path: the file or the folder.
        vocabulary: the names or the order of the keypoints.
        start: the stamp that the column `time` is relative to, nanoseconds.
        minimum_confidence: keypoints with less are left out; 0 is never a keypoint in JSON.

    Raises:
        InputError: the file cannot be read, or has another form.
    """
    if path.is_dir():
        return _openpose_folder(path, vocabulary, minimum_confidence)
    if path.suffix.lower() == '.json':
        return _coco_results(path, vocabulary, minimum_confidence)
    return _table(path, vocabulary, start, minimum_confidence)


def _table(
    path: Path, vocabulary: Vocabulary, start: int, minimum_confidence: float
) -> dict[KeypointsKey, list[Keypoints]]:
    bodies: dict[KeypointsKey, dict[int, NDArray[np.float64]]] = defaultdict(dict)
    form = TableFormat(vocabulary, ('u', 'v'), ('confidence',), start)
    for row in read_table(path, form):
        column, line, confidence = row.values
        if confidence < minimum_confidence:
            continue
        key = ('stamp', row.stamp) if row.stamp is not None else ('frame', row.frame or 0)
        pixels = bodies[key].setdefault(row.body, np.full((len(vocabulary.names), 2), np.nan))
        pixels[row.joint] = column, line
    return {
        key: [Keypoints(body, pixels) for body, pixels in people.items()]
        for key, people in bodies.items()
    }


def _openpose_folder(
    folder: Path, vocabulary: Vocabulary, minimum_confidence: float
) -> dict[KeypointsKey, list[Keypoints]]:
    """Read NAME_NUMBER_keypoints.json; the number is that of the depth image."""
    found: dict[KeypointsKey, list[Keypoints]] = {}
    for path in sorted(folder.glob('*_keypoints.json')):
        match = re.search(r'([0-9]+)_keypoints\.json$', path.name)
        if match is None:
            continue
        key: KeypointsKey = 'frame', int(match.group(1))
        if key in found:
            msg = f'{path} is the second file for depth image {key[1]}; give one for each'
            raise InputError(msg)
        table = read_json(path, 'keypoints', _LARGEST_FILE)
        people = table.get('people') if isinstance(table, dict) else None
        if not isinstance(people, list) or not all(isinstance(each, dict) for each in people):
            msg = f'{path} has no list people of tables; give the files that OpenPose writes'
            raise InputError(msg)
        where = f'{path}, person'
        found[key] = [
            Keypoints(
                _checked_body(f'{where} {number}', number),
                _triples(
                    f'{where} {number}',
                    person.get('pose_keypoints_2d'),
                    vocabulary,
                    minimum_confidence,
                ),
            )
            for number, person in enumerate(people, start=1)
        ]
    if not found:
        msg = f'{folder} has no file NAME_NUMBER_keypoints.json, as OpenPose writes them'
        raise InputError(msg)
    return found


def _coco_results(
    path: Path, vocabulary: Vocabulary, minimum_confidence: float
) -> dict[KeypointsKey, list[Keypoints]]:
    """Read a list of {image_id, keypoints}; the id is the number of the depth image, or stamp."""
    people = read_json(path, 'keypoints', _LARGEST_FILE)
    if not isinstance(people, list):
        msg = f'{path} is no list of {_COCO_FORM}'
        raise InputError(msg)
    found: dict[KeypointsKey, dict[int, Keypoints]] = defaultdict(dict)
    for number, person in enumerate(people):
        where = f'{path}, entry {number} (from 0)'
        image = person.get('image_id') if isinstance(person, dict) else None
        if type(image) is not int or not 0 <= image <= LATEST:
            msg = f'{where} is no {_COCO_FORM}'
            raise InputError(msg)
        of_image = found['stamp' if image > _MOST_FRAMES else 'frame', image]
        body = _checked_body(where, person.get('track_id', len(of_image) + 1))
        if body in of_image:
            msg = f'{where}: body {body} is in image {image} twice; give each another track_id'
            raise InputError(msg)
        pixels = _triples(where, person.get('keypoints'), vocabulary, minimum_confidence)
        of_image[body] = Keypoints(body, pixels)
    return {key: list(of_image.values()) for key, of_image in found.items()}


_COCO_FORM = '{image_id: NUMBER, keypoints: [x, y, c, ...]}'

# Larger numbers of images are stamps.
_MOST_FRAMES = 1_000_000_000_000

# The results of a recording of a day have so many bytes at most.
_LARGEST_FILE = 1 << 30


def _checked_body(where: str, value: object) -> int:
    if type(value) is not int or not 0 <= value <= LARGEST_BODY:
        given = excerpt(repr(value))
        msg = f'{where}: the track_id {given} is not a number from 0 to {LARGEST_BODY}'
        raise InputError(msg)
    return value


def _triples(
    where: str, values: object, vocabulary: Vocabulary, minimum_confidence: float
) -> NDArray[np.float64]:
    """Return the pixels, shape (S, 2), in a list x, y, confidence, x, y, confidence, ..."""
    count = len(vocabulary.names)
    if not isinstance(values, list) or len(values) != 3 * count:
        given = len(values) if isinstance(values, list) else 0
        msg = (
            f'{where} has {given} numbers, but the {count} joints of the vocabulary '
            f'{vocabulary.path.stem} have {3 * count}; name another with --joints'
        )
        raise InputError(msg)
    for value in values:  # NaN and null stand for unknown ones
        if value is not None and (type(value) not in (int, float) or abs(value) > LARGEST_PIXEL):
            msg = f'{where}: {excerpt(repr(value))} is no coordinate of a pixel'
            raise InputError(msg)
    triples = np.array(values, np.float64).reshape(count, 3)
    sure = (triples[:, 2] > 0) & (triples[:, 2] >= minimum_confidence)
    return np.where(sure[:, None], triples[:, :2], np.nan)
