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

"""Opens the labelled recordings of a command and prints their warnings after the work."""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, open_frames
from lsc_pose_ros.cli.output.progress import progress, warn
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError


def add_recording_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the positional argument RECORDING and the options for its topics."""
    parser.add_argument(
        'recordings',
        type=Path,
        nargs='+',
        metavar='RECORDING',
        help='a labelled recording: an .mcap or .db3 file, or a bag folder',
    )
    add_topic_arguments(parser)


def open_recordings(
    arguments: argparse.Namespace, paths: Sequence[Path] | None = None
) -> list[FrameReader]:
    """Open the recordings in `arguments`, or those at `paths` with the same topics.

    Raises:
        InputError: a recording cannot be opened or has no ground truth.
    """
    readers = [
        open_frames(path, arguments) for path in (arguments.recordings if paths is None else paths)
    ]
    for reader in readers:
        if not reader.topics.ground_truth:
            msg = (
                f'{reader.path} has no ground truth (a PointCloud2 topic such as '
                '/ground_truth/skeletons); name its topic with --ground-truth-topic'
            )
            raise InputError(msg)
    return readers


def read_frames(readers: Sequence[FrameReader], description: str) -> Iterator[Frame]:
    """Yield the frames of all `readers` with one progress bar; print warnings to stderr."""
    counts = [reader.count for reader in readers]
    total = None if None in counts else sum(filter(None, counts))
    yield from progress(_chain(readers), total, description)


def _chain(readers: Sequence[FrameReader]) -> Iterator[Frame]:
    for reader in readers:
        yield from reader
        for warning in reader.warnings:
            warn(warning)
