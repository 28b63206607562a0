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

"""Joints of C3D files (c3d.org), the format of marker-based motion capture."""

import warnings
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import check_positions, regular_stamps
from lsc_pose_ros.labels.tracks import BodyTrack
from lsc_pose_ros.labels.vocabulary import Vocabulary

_METRES = {'m': 1.0, 'cm': 0.01, 'mm': 0.001}


def c3d_tracks(
    path: Path, vocabulary: Vocabulary, frame_id: str, scale: float | None, start: int
) -> list[BodyTrack]:
    """Return the bodies of a file, numbered from 1 in the order of their subjects.

    A point is named `SUBJECT:LABEL`, or `LABEL` if the file has one subject.

    Args:
        path: the file.
        vocabulary: the labels of its points.
        frame_id: the frame of the positions.
        scale: metres per unit; None takes the unit that the file names.
        start: the stamp of its first frame, nanoseconds.

    Raises:
        InputError: the file cannot be read, has none of the points or one twice, or names no
            known unit.
    """
    labels, points, rate, unit = _read(path)
    if scale is None and unit not in _METRES:
        named = excerpt(repr(unit))
        msg = f'{path}: the unit {named} is not known; give the metres per unit with --scale'
        raise InputError(msg)
    metres = points * (_METRES[unit] if scale is None else scale)
    check_positions(path, metres)
    subjects: dict[str, dict[str, int]] = defaultdict(dict)
    for index, label in enumerate(labels):
        subject, _, name = label.rpartition(':')
        if name in subjects.get(subject, ()):
            msg = f'{path} has the point {excerpt(label)} twice; export it with one of each name'
            raise InputError(msg)
        if name in vocabulary.names:
            subjects[subject][name] = index
    if not subjects:
        msg = (
            f'{path} has none of the points {vocabulary.listed}, but '
            f'{excerpt(", ".join(labels), 300)}; name the vocabulary with --joints'
        )
        raise InputError(msg)
    stamps = regular_stamps(path, start, len(points), 1 / rate)
    tracks = []
    for body, columns in enumerate(subjects.values(), start=1):
        theirs = np.full((len(points), len(vocabulary.names), 3), np.nan)
        for name, column in columns.items():
            theirs[:, vocabulary.names.index(name)] = metres[:, column]
        tracks.append(BodyTrack(body, frame_id, stamps, vocabulary.ours(theirs)))
    return tracks


def _read(path: Path) -> tuple[list[str], Any, float, str]:
    """Return labels, points of shape (T, P, 3) with NaN where hidden, points/s, and the unit."""
    try:
        import c3d  # noqa: PLC0415 - an optional dependency
    except ImportError:
        msg = 'reading C3D files needs the package c3d; install it with pip install c3d'
        raise InputError(msg) from None
    try:
        with path.open('rb') as stream, warnings.catch_warnings():
            warnings.simplefilter('ignore')  # of labels that the file does not fill
            reader = c3d.Reader(stream)
            labels = [label.strip() for label in reader.point_labels]
            # Frames without points take no bytes: a header could claim any number of them.
            has_points = reader.point_used > 0
            frames = [points for _, points, _ in reader.read_frames()] if has_points else []
            unit = reader.get('POINT:UNITS')
            unit_name = 'mm' if unit is None else unit.string_value.strip().lower()
            rate = float(reader.point_rate)
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror or error}'
        raise InputError(msg) from error
    except Exception as error:  # a damaged file raises exceptions of many types
        msg = f'{path} cannot be read as a C3D file ({excerpt(error)}); export it again'
        raise InputError(msg) from error
    if not frames or not 0 < rate < np.inf:
        msg = f'{path} has no frames of points; export it again'
        raise InputError(msg)
    values = np.array(frames, np.float64)
    # The fourth column is the residual, negative where a marker was not seen.
    hidden = values[..., 3] < 0
    return labels, np.where(hidden[..., None], np.nan, values[..., :3]), rate, unit_name
