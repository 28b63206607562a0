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
"""No change is lost when the recording is written, whatever happens meanwhile."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from waiting import PATIENCE

from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.annotation.journal import Journal, RecordingIdentity
from lsc_pose_ros.annotation.journal_file import JournalFile
from lsc_pose_ros.annotation.labelled_recording import (
    OutputGuard,
    WrittenRecording,
    write_labelled_recording,
)
from lsc_pose_ros.annotation.refusals import Reason, RefusedError
from lsc_pose_ros.annotation.session import Session
from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.tracks import skeletons_of

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from annotation_requests import ask, keep

HAND = JOINT_NUMBERS['l_hand']


@pytest.fixture(scope='module')
def recording(tmp_path_factory, simple_frames):
    """A recording of ten labelled frames; not to be changed."""
    path = tmp_path_factory.mktemp('finish') / 'boxes.mcap'
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame)
    return path


class Work:
    """An annotation of a recording without a server."""

    def __init__(self, recording: Path, output: Path) -> None:
        self._recording, self.output = recording, output
        self.journal = Path(f'{output}.journal')
        file = JournalFile(self.journal)
        self.guard = OutputGuard(output, self.journal)
        store = FrameStore(open_recording(recording))
        self._content = store.content
        identity = RecordingIdentity(recording.name, store.content, store.all_stamps)
        journal = Journal(file, identity)
        self.session = Session(recording.name, store, journal, lambda _: skeletons_of({}))

    def keep(self, number: int, x: float, *, done: bool = True) -> None:
        """Keep the first body of a frame with its hand at `x` metres."""
        frame = self.session.frame(number)
        body = frame['bodies'][0]
        body['joints']['l_hand'] = {'position': [x, 0.0, 2.0]}
        self.session.keep(number, [body], done=done, revision=frame['revision'])

    def write(self, finished: Mapping[int, Skeletons]) -> WrittenRecording:
        reader = open_recording(self._recording)
        return write_labelled_recording(reader, finished, self.guard, self._content)

    def finish(self) -> str:
        return self.session.finish(self.write)

    def hands(self) -> list[float | None]:
        """Return where the hand is in each frame of the output, metres."""
        labels = [frame.ground_truth for frame in open_recording(self.output)]
        return [
            round(float(each.positions[0, HAND, 0]), 3) if len(each.bodies) else None
            for each in labels
        ]


@pytest.fixture
def work(recording, tmp_path):
    """An annotation that has begun."""
    work = Work(recording, tmp_path / 'labelled.mcap')
    yield work
    work.session.close()


def while_it_is_written(work: Work, action: Callable[[], Any]) -> str:
    """Finish, do something before the recording is renamed, and return what finish says."""

    def write(finished: Mapping[int, Skeletons]) -> WrittenRecording:
        written = work.write(finished)
        action()
        return written

    return work.session.finish(write)


def refusal(action: Callable[[], Any]) -> Reason:
    with pytest.raises(
        RefusedError, match=r'; (the change is|it is) not (kept|written again)'
    ) as it:
        action()
    return it.value.reason


def test_a_change_during_the_writing_or_after_it_is_refused(work) -> None:
    work.keep(0, 0.1)
    reasons = []

    def change() -> None:
        reasons.append(refusal(lambda: work.keep(1, 0.2)))
        reasons.append(refusal(work.finish))
        assert work.journal.exists()

    text = while_it_is_written(work, change)
    assert reasons == [Reason.BEING_WRITTEN, Reason.BEING_WRITTEN]
    assert text == f'{work.output}: 10 frames, 1 of them labelled, 1 body'
    assert refusal(lambda: work.keep(1, 0.2)) is Reason.ENDED
    assert refusal(work.finish) is Reason.ENDED
    assert not work.journal.exists()
    assert work.hands() == [0.1, *[None] * 9]
    # What is shown is still what was kept.
    assert work.session.recording()['done'] == [True, *[False] * 9]


def test_changes_from_many_threads_are_kept_or_refused(work) -> None:
    """Each change that was not refused is in the recording, or in the journal that stays."""
    work.keep(0, 1.0)
    kept: dict[int, float] = {0: 1.0}
    begin = threading.Barrier(4, timeout=PATIENCE)

    def change(first: int) -> None:
        begin.wait()
        for number in range(first, 10, 3):
            try:
                work.keep(number, number + 1.0)
            except RefusedError:
                return
            kept[number] = number + 1.0

    threads = [threading.Thread(target=change, args=(first,)) for first in (1, 2, 3)]
    for thread in threads:
        thread.start()
    begin.wait()
    work.finish()
    for thread in threads:
        thread.join()
    assert not work.journal.exists()
    assert work.hands() == [kept.get(number) for number in range(10)]


def test_after_a_failure_the_annotation_goes_on(work) -> None:
    work.keep(0, 0.1)

    def fail(_: Mapping[int, Skeletons]) -> WrittenRecording:
        message = 'the disk is full'
        raise InputError(message)

    with pytest.raises(InputError, match='full'):
        work.session.finish(fail)
    work.keep(1, 0.2)
    work.finish()
    assert work.hands()[:3] == [0.1, 0.2, None]


def test_changes_of_frames_that_are_not_done_stay_in_the_journal(recording, tmp_path) -> None:
    work = Work(recording, tmp_path / 'labelled.mcap')
    work.keep(0, 0.1)
    work.keep(1, 0.2, done=False)
    work.keep(2, 0.3, done=False)
    assert work.finish() == (
        f'{work.output}: 10 frames, 1 of them labelled, 1 body; {work.journal} keeps what is '
        'missing there: frame 1 (not done), frame 2 (not done)'
    )
    again = Work(recording, work.output)
    assert again.session.recording()['done'] == [True, *[False] * 9]
    again.keep(1, 0.2)
    again.keep(2, 0.3)
    again.finish()
    assert again.hands()[:4] == [0.1, 0.2, 0.3, None]
    assert not again.journal.exists()


def test_bodies_that_no_mask_shows_stay_in_the_journal(simple_frames, tmp_path) -> None:
    recording = tmp_path / 'boxes.mcap'
    with RecordingWriter(recording) as writer:
        for frame in simple_frames:
            one = np.where(frame.labels == 1, frame.labels, NO_BODY)
            writer.write_frame(frame._replace(labels=one))
    work = Work(recording, tmp_path / 'labelled.mcap')
    bodies = work.session.frame(0)['bodies']
    assert len(bodies) == 2
    work.session.keep(0, bodies, done=True, revision=0)
    text = work.finish()
    assert '1 body was left out, because no mask shows it' in text
    assert text.endswith(
        f'{work.journal} keeps what is missing there: frame 0 (a body was left out)'
    )
    again = Work(recording, work.output)
    assert len(again.session.frame(0)['bodies']) == 2
    again.session.close()


def test_of_many_frames_that_are_not_done_a_few_are_named(work) -> None:
    work.keep(0, 0.1)
    for number in range(1, 9):
        work.keep(number, 0.2, done=False)
    assert work.finish().endswith('frame 5 (not done), 3 more')


@pytest.mark.parametrize('when', ['before', 'while'])
@pytest.mark.parametrize('existed', [False, True])
def test_an_output_that_another_program_writes_is_not_replaced(
    recording, tmp_path, when, existed
) -> None:
    output = tmp_path / 'labelled.mcap'
    if existed:
        output.write_bytes(recording.read_bytes())
    work = Work(recording, output)
    work.keep(0, 0.1)

    def write_other() -> None:
        other = tmp_path / 'other.mcap'
        other.write_bytes(recording.read_bytes() + b' ')
        other.replace(output)

    if when == 'while':

        class LateWriter(OutputGuard):
            def check(self) -> None:
                super().check()
                write_other()

        work.guard = LateWriter(output, work.journal)
    else:
        write_other()
    with pytest.raises(InputError, match='is not replaced') as refused:
        work.finish()
    assert str(work.journal) in str(refused.value)
    assert output.read_bytes() == recording.read_bytes() + b' '
    assert set(tmp_path.iterdir()) == {output, work.journal}
    # The journal still has all, and what is kept afterwards, too.
    work.keep(1, 0.2)
    work.session.close()
    again = Work(recording, output)
    again.finish()
    assert again.hands()[:2] == [0.1, 0.2]


def test_labels_are_not_written_into_another_recording(simple_frames, tmp_path) -> None:
    """It has the same name and stamps, but shows something else."""
    recording = tmp_path / 'boxes.mcap'
    content = []
    for factor in (1.0, 1.1):
        with RecordingWriter(recording) as writer:
            for frame in simple_frames:
                writer.write_frame(frame._replace(depth=np.float32(factor) * frame.depth))
        content.append(recording.read_bytes())
    recording.write_bytes(content[0])
    work = Work(recording, tmp_path / 'labelled.mcap')
    work.keep(0, 0.1)
    recording.write_bytes(content[1])
    with pytest.raises(InputError, match='another recording than the one that was') as refused:
        work.finish()
    assert str(work.journal) in str(refused.value)
    assert set(tmp_path.iterdir()) == {recording, work.journal}
    recording.write_bytes(content[0])
    work.finish()
    assert work.hands()[0] == 0.1


def test_an_output_has_one_journal_under_all_of_its_names(recording, tmp_path) -> None:
    output, link = tmp_path / 'labelled.mcap', tmp_path / 'link.mcap'
    link.symlink_to(output)
    program = AnnotationProgram(recording, output)
    assert 'is being annotated already' in refused_command(recording, link)
    assert program.end(signal.SIGINT)[0] == 130


def test_labels_of_a_journal_that_is_older_than_the_output_are_told(recording, tmp_path) -> None:
    output = tmp_path / 'labelled.mcap'
    work = Work(recording, output)
    work.keep(0, 0.1)
    work.session.close()
    output.write_bytes(recording.read_bytes())
    for name, warned in ((work.journal, False), (output, True)):
        for path in (output, work.journal):
            os.utime(path, ns=(0, 2 * 10**9 if path == name else 10**9))
        program = AnnotationProgram(recording, output)
        status, _, errors = program.end(signal.SIGINT)
        assert status == 130
        assert ('both have labels of 1 frame:' in errors) == warned, errors


def test_an_output_that_is_gone_is_written(recording, tmp_path) -> None:
    output = tmp_path / 'labelled.mcap'
    output.write_bytes(recording.read_bytes())
    work = Work(recording, output)
    work.keep(0, 0.1)
    output.unlink()
    work.finish()
    assert work.hands()[0] == 0.1


def test_a_change_of_labels_that_another_page_has_changed_is_refused(work) -> None:
    first = work.session.frame(3)
    second = work.session.frame(3)
    answer = work.session.keep(3, [], done=True, revision=first['revision'])
    assert answer['revision'] != first['revision']
    with pytest.raises(RefusedError, match='frame 3 was changed on another page') as refused:
        work.session.keep(3, second['bodies'], done=True, revision=second['revision'])
    assert refused.value.reason is Reason.STALE
    for wrong in (None, '0', True):
        with pytest.raises(RefusedError):
            work.session.keep(3, [], done=False, revision=wrong)
    assert work.session.frame(3)['bodies'] == []
    # Another frame is not concerned.
    work.session.keep(4, [], done=True, revision=second['revision'])


def test_the_program_answers_with_statuses(recording, tmp_path) -> None:
    program = AnnotationProgram(recording, tmp_path / 'labelled.mcap')
    bodies = ask(program, 'GET', '/frame/0')[1]['bodies']
    assert keep(program, 0, bodies)[0] == 200
    stale = {'bodies': [], 'done': True, 'revision': 0}
    status, answer = ask(program, 'POST', '/keep/0', stale)
    assert status == 409
    assert 'frame 0 was changed on another page' in answer['error']
    Path(f'{tmp_path}/labelled.mcap.journal').unlink()
    status, answer = keep(program, 1, [])
    assert status == 507
    assert 'the change is not kept' in answer['error']
    # What was kept before is not lost.
    assert ask(program, 'POST', '/finish', {})[0] == 200
    assert program.end()[0] == 0
    frames = list(open_recording(tmp_path / 'labelled.mcap'))
    assert [len(frame.ground_truth.bodies) for frame in frames] == [2, *[0] * 9]


def refused_command(recording: Path, output: Path, setup: str = '') -> str:
    """Return the one line that the command prints, which does not begin."""
    program = f'{setup}\nimport sys; from lsc_pose_ros.cli.main import main; sys.exit(main())'
    words = ['annotate', str(recording), '-o', str(output), '--no-browser', '--quiet']
    found = subprocess.run(
        [sys.executable, '-c', program, *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert (found.returncode, found.stdout) == (2, ''), found.stderr
    assert len(found.stderr.splitlines()) == 1
    return found.stderr


def test_a_second_annotation_of_one_output_is_refused(recording, tmp_path) -> None:
    output = tmp_path / 'labelled.mcap'
    program = AnnotationProgram(recording, output)
    try:
        error = refused_command(recording, output)
        assert f'{output}.journal is in use: this output is being annotated already' in error
        assert keep(program, 0, [{'number': 1, 'joints': {}}])[0] == 200
    finally:
        program.end(signal.SIGINT)


@pytest.mark.parametrize('name', ['labelled.txt', 'labelled.db3', 'bag'])
def test_an_output_that_could_not_be_gone_on_with_is_refused(recording, tmp_path, name) -> None:
    assert 'annotations are written to a file .mcap' in refused_command(recording, tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('output', ['-', '/dev/null'])
def test_an_output_that_cannot_be_read_again_is_refused(recording, output) -> None:
    assert 'give -o a file' in refused_command(recording, Path(output))


def test_without_a_temporary_folder_there_is_one_sentence(recording, tmp_path) -> None:
    setup = 'import tempfile; tempfile._candidate_tempdir_list = lambda: ["/proc/none"]'
    error = refused_command(recording, tmp_path / 'out.mcap', setup)
    assert 'no temporary file can be written' in error
    assert 'TMPDIR' in error
    assert list(tmp_path.iterdir()) == []
