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
"""`lsc_pose annotate`: labels a recording by hand, in a browser."""

import argparse
import os
import threading
import webbrowser
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from lsc_pose_ros.annotation.earlier_labels import earlier_labels
from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal, RecordingIdentity
from lsc_pose_ros.annotation.journal_file import JournalFile
from lsc_pose_ros.annotation.labelled_recording import OutputGuard, write_labelled_recording
from lsc_pose_ros.annotation.server import AnnotationServer
from lsc_pose_ros.annotation.session import Session
from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.bags.storage.writer import MCAP_SUFFIX, RECORDING
from lsc_pose_ros.cli.commands.label_command import open_unturned
from lsc_pose_ros.cli.options.numbers import positive_int
from lsc_pose_ros.cli.options.setting_options import add_setting_options, settings_from
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.progress import progress, warn
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.files.output_place import is_written_through
from lsc_pose_ros.files.sibling_names import sibling
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.settings.table import MASK, FrameSettings
from lsc_pose_ros.viz.report.page_style import colour_sheet

HELP = """Label a recording by hand: a page in the browser shows each depth image with the answer
of the model, or the labels that there are, and joints are dragged to where they belong. Each
change is kept at once; the same command goes on where an interrupted one ended, and with the
labels of an output that is there already. docs/labels.md shows how."""

JOURNAL_SUFFIX = '.journal'
"""What follows the name of the output in that of the journal."""

_LARGEST_PORT = 65_535


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        metavar='RECORDING',
        help='the recording: an .mcap or .db3 file, or a bag folder',
    )
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        metavar='LABELLED',
        help='the labelled recording (default: RECORDING_labelled.mcap in this folder)',
    )
    parser.add_argument(
        '--every',
        type=positive_int,
        default=1,
        metavar='N',
        help='label only each N-th frame (default: %(default)s)',
    )
    parser.add_argument(
        '--port', type=int, default=0, metavar='PORT', help='of the page (default: any free one)'
    )
    parser.add_argument(
        '--browser',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='open the page in the browser (default: %(default)s)',
    )
    add_setting_options(parser, 'model')
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve the page until it finishes, and return the exit status.

    Raises:
        InputError: the recording, the journal or the output cannot be used.
    """
    if arguments.output is None:
        arguments.output = Path(f'{arguments.recording.stem}_labelled.mcap')
    if not 0 <= arguments.port <= _LARGEST_PORT:
        msg = f'--port is {arguments.port}; give 0 to {_LARGEST_PORT}'
        raise InputError(msg)
    check_outputs([Output(arguments.output, RECORDING)], [arguments.recording])
    if is_written_through(arguments.output):
        msg = f'{arguments.output} cannot be read again to go on; give -o a file'
        raise InputError(msg)
    if arguments.output.suffix != MCAP_SUFFIX:
        # The output is read again to go on, and is replaced at the end: one file.
        msg = (
            f'{arguments.output}: annotations are written to a file {MCAP_SUFFIX}; name one by -o'
        )
        raise InputError(msg)
    # Locked before the labels of the output are read, which another process could write else.
    with closing(JournalFile(journal_path(arguments.output))) as file:
        return _annotate(arguments, file)


def journal_path(output: Path) -> Path:
    """Return the journal of an output: one for all names of the file.

    Raises:
        InputError: `output` is a folder.
    """
    return sibling(Path(os.path.realpath(output)), JOURNAL_SUFFIX)


def _annotate(arguments: argparse.Namespace, file: JournalFile) -> int:
    if not file.is_locked:
        warn(f'{file.path} cannot be locked; do not annotate this output twice at once')
    output = OutputGuard(arguments.output, file.path)
    estimator = Estimator(load_model(find_model(arguments.model)))
    store = _read_frames(arguments)
    earlier = _read_earlier(arguments, store)
    name = arguments.recording.name
    journal = Journal(file, RecordingIdentity(name, store.content, frozenset(store.all_stamps)))
    for warning in journal.warnings:
        warn(warning)
    if output.is_newer:
        _warn_of_older_labels(output, len(journal.frames.keys() & earlier.keys()))
    session = Session(
        name,
        store,
        journal,
        lambda frame: estimator.estimate(frame.depth, frame.labels, frame.camera),
        earlier,
    )
    with closing(session):
        print(_serve(arguments, session, output, store.content), flush=True)
    return 0


def _warn_of_older_labels(output: OutputGuard, frames: int) -> None:
    if frames:
        count = '1 frame' if frames == 1 else f'{frames} frames'
        warn(
            f'{output.path} was written after {output.journal}; both have labels of {count}: '
            'those of the journal are shown and will be written; to use those of the output, move '
            'the journal away'
        )


def _read_frames(arguments: argparse.Namespace) -> FrameStore:
    settings = replace(settings_from(arguments, FrameSettings), camera_roll='0')
    reader = open_recording(arguments.recording, topics_of(arguments), settings=settings)
    frames = progress(reader, reader.count, 'reading')
    store = FrameStore(frames, arguments.every)
    for warning in reader.warnings:
        warn(warning)
    return store


def _read_earlier(arguments: argparse.Namespace, store: FrameStore) -> Mapping[int, Skeletons]:
    """Return the labels of the output that there is already, by stamp."""
    output = arguments.output
    if not output.exists():
        return {}
    settings = replace(settings_from(arguments, FrameSettings), camera_roll='0', segmentation=MASK)
    try:
        reader = open_recording(output, topics_of(arguments), settings=settings, need_mask=False)
        earlier = earlier_labels(progress(reader, reader.count, 'reading'), store)
    except InputError as error:
        msg = f'{error}; move it away, or name another output with -o'
        raise InputError(msg) from error
    if earlier is None:
        msg = (
            f'{output} exists, and is no annotation of {arguments.recording}; '
            'move it away, or name another output with -o'
        )
        raise InputError(msg)
    count = f'{len(earlier)} of {len(store.all_stamps)} frames'
    print(f'{output} has labels of {count}; they stay, and can be changed.', flush=True)
    return earlier


def _serve(
    arguments: argparse.Namespace, session: Session, output: OutputGuard, content: str
) -> str:
    """Serve the page until the recording is written, and return what this contains."""

    def finish() -> str:
        return session.finish(
            lambda labels: write_labelled_recording(
                open_unturned(arguments), labels, output, content
            )
        )

    server = AnnotationServer(session, finish, colour_sheet(), arguments.port)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(f'Annotate at {server.address}', flush=True)
    print(
        f'Ctrl-C stops. What was done is in {output.journal}; the same command goes on.',
        flush=True,
    )
    if arguments.browser:
        webbrowser.open(server.address)
    try:
        while not server.ended.wait(0.5):  # a wait without end would not notice Ctrl-C on Windows
            pass
    finally:
        server.shutdown()
        server.server_close()
    return server.summary
