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

"""Writes joints as tables that other programs read: CSV, Parquet, npz, JSON and BVH."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.cli.input.joint_sequence import JointSequence
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import JSON, TEXT, Kind, archive, begins_with
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.synthetic.mocap.bvh_writer import bvh_text

_SECOND = 1_000_000_000

_KINDS: dict[str, Kind] = {
    '.csv': TEXT,
    '.parquet': begins_with('a Parquet file', b'PAR1'),
    '.npz': archive('an archive of joints', 'positions.npy'),
    '.json': JSON,
    '.bvh': begins_with('a BVH file', b'HIERARCHY'),
}
"""The kinds of files that joints are written as, by the suffix."""

Columns = dict[str, NDArray[Any]]


def kind_of_table(path: Path) -> Kind:
    """Return the kind of the file that joints are written to.

    Raises:
        InputError: its suffix is unknown.
    """
    if path.suffix not in _KINDS:
        known = ', '.join(_KINDS)
        msg = f'{path}: joints are written as {known}, not as {path.suffix or "this"}'
        raise InputError(msg)
    return _KINDS[path.suffix]


def write_joints(path: Path, sequence: JointSequence, *, wide: bool, body: int | None) -> None:
    """Write `sequence` in the format that the suffix of `path` names.

    Args:
        path: the file; .csv, .parquet, .npz, .json or .bvh.
        sequence: the joints.
        wide: CSV and Parquet get one row for each body instead of one for each joint.
        body: the body of a BVH file; None for the one that is seen most often.

    Raises:
        InputError: the file cannot be written, its suffix is unknown, or a package is missing.
    """
    writers = {
        '.csv': lambda: _csv(columns_of(sequence, wide=wide)),
        '.parquet': lambda: _parquet(columns_of(sequence, wide=wide), sequence),
        '.npz': lambda: _npz(sequence),
        '.json': lambda: _json(sequence),
        '.bvh': lambda: _bvh(sequence, body),
    }
    kind = kind_of_table(path)
    write_output(path, kind, writers[path.suffix]())


def columns_of(sequence: JointSequence, *, wide: bool) -> Columns:
    """Return the columns of a table; stamps are integers, nanoseconds."""
    joints = sequence.joints
    if wide:
        columns: Columns = {'stamp': sequence.stamps, 'body': sequence.bodies}
        for index, name in enumerate(joints):
            for axis, letter in enumerate('xyz'):
                columns[f'{name}_{letter}'] = sequence.positions[:, index, axis]
            columns[f'{name}_confidence'] = sequence.confidence[:, index]
        return columns
    flat = sequence.positions.reshape(-1, 3)
    return {
        'stamp': np.repeat(sequence.stamps, len(joints)),
        'body': np.repeat(sequence.bodies, len(joints)),
        'joint': np.tile(np.array(joints), len(sequence.stamps)),
        'x': flat[:, 0],
        'y': flat[:, 1],
        'z': flat[:, 2],
        'confidence': sequence.confidence.reshape(-1),
    }


def _csv(columns: Columns) -> bytes:
    """Return the rows as text; stamps are seconds with nine decimals, unknown numbers empty."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator='\n')
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        seconds, rest = divmod(int(row[0]), _SECOND)
        writer.writerow([f'{seconds}.{rest:09d}', *map(_cell, row[1:])])
    return stream.getvalue().encode()


def _cell(value: object) -> str:
    if isinstance(value, np.floating):
        return f'{value:.6g}' if np.isfinite(value) else ''
    return str(value)


def _parquet(columns: Columns, sequence: JointSequence) -> bytes:
    try:
        import pyarrow as pa  # noqa: PLC0415 - an optional dependency
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ImportError:
        msg = 'writing Parquet needs the package pyarrow; install it with pip install pyarrow'
        raise InputError(msg) from None
    arrays = {
        name: pa.array(values, from_pandas=values.dtype.kind == 'f')  # NaN becomes null
        for name, values in columns.items()
    }
    arrays['stamp'] = arrays['stamp'].cast(pa.timestamp('ns'))
    table = pa.table(arrays).replace_schema_metadata({'frame_id': sequence.frame_id})
    stream = io.BytesIO()
    pq.write_table(table, stream)
    return stream.getvalue()


def _npz(sequence: JointSequence) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(
        stream,
        stamps=sequence.stamps,
        bodies=sequence.bodies,
        joints=np.array(sequence.joints),
        positions=sequence.positions.astype(np.float32),
        confidence=sequence.confidence.astype(np.float32),
        frame_id=np.array(sequence.frame_id),
    )
    return stream.getvalue()


def _json(sequence: JointSequence) -> bytes:
    bodies = [
        {
            'stamp_ns': int(stamp),
            'body': int(body),
            'joints': {
                name: {
                    'position': position.round(6).tolist()
                    if np.isfinite(position).all()
                    else None,
                    'confidence': round(float(confidence), 6),
                }
                for name, position, confidence in zip(
                    sequence.joints, positions, confidences, strict=True
                )
            },
        }
        for stamp, body, positions, confidences in zip(
            sequence.stamps, sequence.bodies, sequence.positions, sequence.confidence, strict=True
        )
    ]
    table = {'topic': sequence.topic, 'frame_id': sequence.frame_id, 'bodies': bodies}
    return json.dumps(table, indent=1, allow_nan=False).encode() + b'\n'


def _place(position: NDArray[np.float64]) -> list[float] | None:
    known = bool(np.isfinite(position).all())
    return [round(float(each), 6) for each in position] if known else None


def _bvh(sequence: JointSequence, body: int | None) -> bytes:
    numbers, counts = np.unique(sequence.bodies, return_counts=True)
    chosen = int(numbers[counts.argmax()]) if body is None else body
    if chosen not in numbers:
        known = ', '.join(map(str, numbers))
        msg = f'there is no body {chosen} in {sequence.topic}; its bodies are {known}'
        raise InputError(msg)
    rows = sequence.bodies == chosen
    stamps, positions = sequence.stamps[rows], sequence.positions[rows]
    if len(stamps) < 2:
        msg = f'body {chosen} is in one frame only; a BVH file needs two or more'
        raise InputError(msg)
    # BVH has no stamps: frames that are missing are those of before.
    step = float(np.median(np.diff(stamps)))
    moments = np.rint((stamps - stamps[0]) / step).astype(np.int64)
    latest = np.searchsorted(moments, np.arange(moments[-1] + 1), 'right') - 1
    full = np.full((len(latest), len(JOINT_NAMES), 3), np.nan)
    full[:, [JOINT_NUMBERS[name] for name in sequence.joints]] = positions[latest]
    try:
        return bvh_text(full, step / _SECOND).encode()
    except ValueError as error:
        msg = f'body {chosen} cannot be written as BVH: {error}'
        raise InputError(msg) from error
