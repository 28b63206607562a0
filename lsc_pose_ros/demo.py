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

"""The demonstration: `python -m lsc_pose_ros.demo --directory DIR`.

The live node starts with the model that comes with the package and answers a test recording that
is played to it over real ROS 2; its answers are checked against the truth. Then a model of one's
own is trained on synthetic people, and both are measured on the same frames.
"""

import argparse
import heapq
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lsc_pose_ros.bags import RecordingWriter, SerializedMessage, open_recording, read_messages
from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.cli import main as command_line
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import joint_errors
from lsc_pose_ros.messages.type_names import POINT_CLOUD
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.resources.package_files import default_model
from lsc_pose_ros.ros.isolation import isolated_environment
from lsc_pose_ros.ros.requirements import load_with_ros

if TYPE_CHECKING:
    from lsc_pose_ros.data_types.skeletons import Skeletons

TRAINING_FRAMES = 1500
TEST_FRAMES = 200
TEST_RATE = 10  # frames a second: a busy computer of two cores keeps up with it

MOST_ERROR = 0.08
LEAST_ANSWERED = 0.95

_START_TIMEOUT = 120.0
_END_TIMEOUT = 20.0


class Files(NamedTuple):
    """What the demonstration makes."""

    test: Path
    live: Path
    picture: Path
    log: Path
    training: Path
    model: Path
    scores: Path


class Outcome(NamedTuple):
    """How well the live node did.

    Attributes:
        frames: how many frames were played.
        answered: in how many of them the node found joints of everybody.
        mean_error: of all labelled joints that it found, metres.
    """

    frames: int
    answered: int
    mean_error: float

    @property
    def passed(self) -> bool:
        """Whether that is good enough."""
        enough = self.answered >= LEAST_ANSWERED * self.frames
        return enough and self.mean_error <= MOST_ERROR


class Score(NamedTuple):
    """How good a model is on the test recording, offline.

    Attributes:
        mean_error: metres.
        share: of the joints within 10 cm.
    """

    mean_error: float
    share: float


def main(words: Sequence[str] | None = None) -> int:
    """Run the demonstration; return 0 if the live node did well."""
    parser = argparse.ArgumentParser(prog='python -m lsc_pose_ros.demo', description=__doc__)
    parser.add_argument(
        '--directory', type=Path, default=Path('demo'), help='where the files go (default: demo)'
    )
    directory = parser.parse_args(words).directory
    begin = time.monotonic()
    try:
        files = _files(directory)
        outcome = demonstrate(files)
        scores = train_beside(files)
    except InputError as error:
        sys.stderr.write(f'demo: error: {error}\n')
        return command_line.BAD_INPUT
    except KeyboardInterrupt:
        return command_line.INTERRUPTED
    _say(summary(outcome, scores, files, time.monotonic() - begin))
    return 0 if outcome.passed else 1


def demonstrate(files: Files) -> Outcome:
    """Make all of `files` and return how well the live node did.

    Raises:
        InputError: ROS 2 or the model of the package is not there, or the node does not start.
    """
    os.environ.update(isolated_environment())  # before anything of ROS is loaded
    load_with_ros('rclpy')
    default = default_model()
    # While the node compiles its kernels, it has company.
    with _live_node(files, default):
        _run_step('synth', files.test, '--frames', TEST_FRAMES, '--seed', 2, '--fps', TEST_RATE)
        answers = _answers(files)
    write_live(files, answers)
    _run_step('view', files.live, '-o', files.picture)
    return compare(files.live)


def train_beside(files: Files) -> dict[str, Score]:
    """Train a model of one's own, and return how good it and the package's are, by name."""
    joints = names_of(load_model(default_model()).joints)
    _run_step('synth', files.training, '--frames', TRAINING_FRAMES, '--seed', 1)
    _run_step('train', files.training, '-o', files.model, '--joints', *joints)
    return {
        "the package's": _measure(files, default_model()),
        'the one trained here': _measure(files, files.model),
    }


def write_live(files: Files, answers: Sequence[SerializedMessage]) -> None:
    """Write the test recording with the node's `answers` put where their frames are."""
    placed = [answer._replace(log_time=read_skeletons(answer.data).stamp) for answer in answers]
    placed.sort(key=lambda answer: answer.log_time)
    with RecordingWriter(files.live) as writer:
        for message in heapq.merge(read_messages(files.test), placed, key=lambda m: m.log_time):
            writer.write(message.topic, message.type_name, message.log_time, message.data)


def compare(recording: Path) -> Outcome:
    """Return how well the answers in `recording` agree with its truth."""
    answers: dict[int, Skeletons] = {}
    for message in read_messages(recording):
        if message.topic == SKELETONS_TOPIC:
            stamp, skeletons = read_skeletons(message.data)
            answers[stamp] = skeletons
    frames = answered = 0
    errors: list[float] = []
    for frame in open_recording(recording):
        frames += 1
        if frame.ground_truth is None or frame.stamp not in answers:
            continue
        distances = joint_errors(answers[frame.stamp], frame.ground_truth)
        found = np.isfinite(distances)
        answered += bool(found.any(axis=1).all())
        errors.extend(distances[found].tolist())
    return Outcome(frames, answered, float(np.mean(errors)) if errors else float('inf'))


def summary(outcome: Outcome, scores: dict[str, Score], files: Files, seconds: float) -> str:
    """Return what the user is told at the end."""
    verdict = 'as good as expected' if outcome.passed else 'NOT as good as expected'
    rows = '\n'.join(
        f'{name:<22}{100 * score.mean_error:>8.1f} cm{100 * score.share:>14.1f} %'
        for name, score in scores.items()
    )
    return f"""
The live node answered {outcome.answered} of {outcome.frames} frames over ROS 2.
Mean error of its joints: {100 * outcome.mean_error:.1f} cm (at most {100 * MOST_ERROR:.0f} cm).
That is {verdict}; all took {seconds:.0f} s.

{'model':<22}{'mean error':>11}{'within 10 cm':>16}
{rows}

The node's answers, beside the truth: {files.live}
The same as a picture:                {files.picture}
The model trained here:               {files.model}
"""


def _files(directory: Path) -> Files:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        msg = f'{directory}: cannot be made ({error.strerror}); choose another --directory'
        raise InputError(msg) from error
    names = (
        'test.mcap', 'live.mcap', 'live.png', 'node.log', 'training.mcap', 'model.npz',
        'scores.json',
    )  # fmt: skip
    return Files(*(directory / name for name in names))


def _run_step(*words: object) -> None:
    """Run one `lsc_pose` command here; its complaints and its status are the demo's own."""
    plain = [str(word) for word in words]
    _say(f'\n$ lsc_pose {" ".join(plain)}')
    status = command_line.main(plain)
    if status:
        raise SystemExit(status)


def _measure(files: Files, model: Path) -> Score:
    _run_step('evaluate', model, files.test, '--json', files.scores)
    results = json.loads(files.scores.read_text(encoding='utf-8'))
    return Score(results['mean_error_m'], results['map'])


def _answers(files: Files) -> list[SerializedMessage]:
    """Play the test recording to the node and return what it answers."""
    with _listener() as listener:
        _run_step('replay', files.test, '--publish', '--wait-for', _START_TIMEOUT)
        listener.wait_for_messages(TEST_FRAMES, _END_TIMEOUT)
        return list(listener.received)


@contextmanager
def _listener() -> Iterator[Any]:
    """Give a listener to the node's answers, once it has found the node."""
    opened = load_with_ros('lsc_pose_ros.ros.playback.listener').open_listener
    with opened({SKELETONS_TOPIC: POINT_CLOUD}) as listener:
        if not listener.wait_for_publishers(_START_TIMEOUT):
            msg = f'pose_node did not advertise {SKELETONS_TOPIC} in {_START_TIMEOUT:g} s'
            raise InputError(msg)
        yield listener


@contextmanager
def _live_node(files: Files, model: Path) -> Iterator[None]:
    """Run pose_node with `model` in a process of its own."""
    words = ['--ros-args', '-p', f'model:={model}']
    _say(f'\n$ pose_node {" ".join(words)}')
    with files.log.open('wb') as log:
        node = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, '-m', 'lsc_pose_ros.ros.node.main', *words],
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            yield
            if node.poll() is not None:
                msg = f'pose_node ended by itself with status {node.returncode}; see {files.log}'
                raise InputError(msg)
        finally:
            _stop(node)


def _stop(node: subprocess.Popen[bytes]) -> None:
    node.send_signal(signal.SIGINT)
    try:
        node.wait(_END_TIMEOUT)
    except subprocess.TimeoutExpired:
        node.kill()
        node.wait()


def _say(text: str) -> None:
    sys.stdout.write(f'{text}\n')
    sys.stdout.flush()


if __name__ == '__main__':
    sys.exit(main())
