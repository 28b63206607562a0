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

"""`lsc_pose info`: prints the contents of a recording or a model."""

import argparse
from collections import deque
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from lsc_pose_ros.bags.inspection import Inspection, RecordingReport
from lsc_pose_ros.cli.options.setting_options import settings_from
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.cli.output.terminal_text import line_of, name_of
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.resources.package_files import find_model, shipped_models
from lsc_pose_ros.settings.table import BACKGROUND, PEOPLE, FrameSettings

HELP = (
    'Print the contents of a recording or a model. The whole recording is read, including its '
    'checksums, so that the counts and warnings are reliable.'
)

_NO_MASK = f'{PEOPLE} or {BACKGROUND}'

_ZIP_MAGIC = b'PK\x03\x04'
_MODEL_SUFFIX = '.npz'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'path',
        type=Path,
        metavar='PATH',
        help='a recording (file or bag folder), a model, or the name of a model of the package',
    )
    parser.add_argument(
        '--json', type=Path, metavar='FILE', help='also write the contents as JSON to FILE'
    )
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the contents of `arguments.path` and return the exit status.

    Raises:
        InputError: the path is neither a recording nor a model, or the JSON cannot be written.
    """
    path = arguments.path
    if not path.exists() and str(path) in shipped_models():
        path = find_model(path)
    if arguments.json is not None:
        check_outputs([Output(arguments.json, JSON)], [path])
    contents = _describe_model(path) if _is_model(path) else _describe_recording(arguments)
    if arguments.json is not None:
        write_json(arguments.json, contents)
    return 0


def _is_model(path: Path) -> bool:
    if path.suffix == _MODEL_SUFFIX:
        return True
    try:
        with path.open('rb') as stream:
            return stream.read(len(_ZIP_MAGIC)) == _ZIP_MAGIC
    except OSError:  # a folder or missing: the reader of recordings reports it
        return False


def _describe_model(path: Path) -> dict[str, Any]:
    # Imported here, because the description of a recording does not need the method.
    from lsc_pose_ros.model_io.model_file import describe_model, load_model  # noqa: PLC0415

    description = describe_model(load_model(path))
    width = max((len(name_of(name)) for name in description), default=0)
    print(f'{"model":{width}}  {path}')
    description = {'size': f'{path.stat().st_size * 1e-6:.1f} MB', **description}
    for name, value in description.items():
        print(f'{name_of(name):{width}}  {line_of(value)}')
    return {'kind': 'model', 'path': str(path), **description}


def _describe_recording(arguments: argparse.Namespace) -> dict[str, Any]:
    inspection = Inspection(
        arguments.path, topics_of(arguments), settings_from(arguments, FrameSettings)
    )
    deque(progress(inspection, inspection.total, 'reading'), maxlen=0)
    report = inspection.report()
    _print_recording(report)
    topics = [topic._asdict() for topic in report.topics]
    return {'kind': 'recording', **report._asdict(), 'topics': topics}


def _print_recording(report: RecordingReport) -> None:
    start = datetime.fromtimestamp(report.start_ns * 1e-9, timezone.utc)
    frame_topics = ', '.join(
        f'{name} {name_of(topic)}' for name, topic in report.frame_topics.items()
    )
    print(f'recording  {report.path}')
    print(f'files      {len(report.files)}, {report.size_bytes * 1e-6:.1f} MB')
    print(f'start      {start.isoformat(timespec="milliseconds")}')
    print(f'duration   {report.duration_s:.1f} s')
    print(f'messages   {report.messages}')
    print(f'frames     {report.frames}, labelled {report.labelled_frames}')
    print(f'made of    {frame_topics or "-"}')
    if report.frames and not report.frame_topics.get('mask'):
        print(f'masks      none are used; --segmentation {_NO_MASK} finds people without')
    print(f'images     {line_of("; ".join(report.images) or "-")}')
    print(f'camera     {line_of(report.camera or "-")}')
    print(f'roll       {line_of(report.camera_roll or "-")}')
    print('topics')
    width = max((len(name_of(topic.name)) for topic in report.topics), default=0)
    for topic in report.topics:
        name, kind = name_of(topic.name), name_of(topic.type_name)
        print(f'  {name:{width}}  {topic.messages:7d}  {kind}')
    for warning in report.warnings:
        print(f'warning: {line_of(warning)}')
