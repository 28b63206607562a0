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

The live node runs with the default model. First it finds two people in a furnished room, without
any mask. Then a test recording with masks is published over ROS 2, and the skeletons that the node
publishes are compared with the ground truth. Then a second model is
trained on synthetic people, and both models are evaluated on the same frames.
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
from lsc_pose_ros.cli.program import INTERRUPTED
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import joint_errors
from lsc_pose_ros.messages.type_names import POINT_CLOUD
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.resources.package_files import default_model
from lsc_pose_ros.ros.isolation import isolated_environment
from lsc_pose_ros.ros.requirements import load_with_ros
from lsc_pose_ros.training.samples import select_joints

if TYPE_CHECKING:
    from lsc_pose_ros.data_types.skeletons import Skeletons

TRAINING_FRAMES = 1500
TEST_FRAMES = 200
ROOM_FRAMES, ROOM_SEED = 60, 1
TEST_RATE = 10  # frames per second; a busy computer with two cores can keep up

MOST_ERROR = 0.08
LEAST_ESTIMATED = 0.95

FOUND_WITHIN = 0.3
"""A person is found if the joints of an estimate are this near on average, metres."""

_START_TIMEOUT = 120.0
_END_TIMEOUT = 20.0


class Files(NamedTuple):
    """The files that the demonstration writes."""

    room: Path
    room_live: Path
    room_picture: Path
    room_log: Path
    test: Path
    live: Path
    picture: Path
    log: Path
    training: Path
    model: Path
    scores: Path


class LiveResult(NamedTuple):
    """The accuracy of the live node.

    Attributes:
        frames: the number of published frames.
        estimated: the number of frames with joints of each labelled person.
        mean_error: the mean error of the labelled joints that were estimated, metres.
    """

    frames: int
    estimated: int
    mean_error: float

    @property
    def passed(self) -> bool:
        """Whether the number of frames and the error are within the limits."""
        enough = self.estimated >= LEAST_ESTIMATED * self.frames
        return enough and self.mean_error <= MOST_ERROR


class RoomResult(NamedTuple):
    """The people that the live node found in the furnished room.

    Attributes:
        people: the number of people, summed over the frames.
        found: how many of them were found.
        mean_error: the mean error of the joints of those, metres.
    """

    people: int
    found: int
    mean_error: float


class ModelAccuracy(NamedTuple):
    """The accuracy of a model on the test recording, offline.

    Attributes:
        mean_error: metres.
        fraction: the fraction of the joints within 10 cm.
    """

    mean_error: float
    fraction: float


def main(words: Sequence[str] | None = None) -> int:
    """Run the demonstration; return 0 if the live node is accurate enough."""
    parser = argparse.ArgumentParser(prog='python -m lsc_pose_ros.demo', description=__doc__)
    parser.add_argument(
        '--directory',
        type=Path,
        default=Path('demo'),
        help='output folder (default: demo)',
    )
    directory = parser.parse_args(words).directory
    begin = time.monotonic()
    try:
        files = _files(directory)
        room = run_room(files)
        result = run_live(files)
        accuracies = compare_models(files)
    except InputError as error:
        sys.stderr.write(f'demo: error: {error}\n')
        return command_line.BAD_INPUT
    except KeyboardInterrupt:
        return INTERRUPTED
    _say(summary(room, result, accuracies, files, time.monotonic() - begin))
    return 0 if result.passed else 1


def run_room(files: Files) -> RoomResult:
    """Publish a furnished room to the live node and return the people that it finds.

    Raises:
        InputError: ROS 2 or the default model is not installed, or the node does not start.
    """
    os.environ.update(isolated_environment())  # before ROS is loaded
    load_with_ros('rclpy')
    options = ('--people', 2, '--furniture', '--seed', ROOM_SEED, '--fps', TEST_RATE)
    # The node compiles its kernels while the recording is generated.
    with _live_node(files.room_log, default_model(), 'segmentation:=people'):
        _run_step('synth', files.room, '--frames', ROOM_FRAMES, *options)
        estimates = _published_estimates(files.room, ROOM_FRAMES, '--segmentation', 'people')
    write_live(files.room, files.room_live, estimates)
    _run_step('view', files.room_live, '-o', files.room_picture)
    return room_result(files.room_live)


def run_live(files: Files) -> LiveResult:
    """Publish a test recording to the live node and return the accuracy of its skeletons.

    Raises:
        InputError: the default model is not installed, or the node does not start.
    """
    with _live_node(files.log, default_model()):
        _run_step('synth', files.test, '--frames', TEST_FRAMES, '--seed', 2, '--fps', TEST_RATE)
        estimates = _published_estimates(files.test, TEST_FRAMES)
    write_live(files.test, files.live, estimates)
    _run_step('view', files.live, '-o', files.picture)
    return live_result(files.live)


def compare_models(files: Files) -> dict[str, ModelAccuracy]:
    """Train a model; return the accuracy of the default model and of the new one, by name."""
    joints = names_of(load_model(default_model()).joints)
    _run_step('synth', files.training, '--frames', TRAINING_FRAMES, '--seed', 1)
    _run_step('train', files.training, '-o', files.model, '--joints', *joints)
    return {
        'default model': _evaluate(files, default_model()),
        'trained model': _evaluate(files, files.model),
    }


def write_live(recording: Path, live: Path, estimates: Sequence[SerializedMessage]) -> None:
    """Write a copy of `recording` with the node's `estimates`, each at the time of its frame."""
    sorted_estimates = sorted(
        (each._replace(log_time=read_skeletons(each.data).stamp) for each in estimates),
        key=lambda message: message.log_time,
    )
    with RecordingWriter(live) as writer:
        for message in heapq.merge(
            read_messages(recording), sorted_estimates, key=lambda m: m.log_time
        ):
            writer.write(message.topic, message.type_name, message.log_time, message.data)


def live_result(recording: Path) -> LiveResult:
    """Return the accuracy of the estimates in `recording`, compared with its ground truth."""
    estimates = _read_estimates(recording)
    frames = estimated = 0
    errors: list[float] = []
    for frame in open_recording(recording):
        frames += 1
        if frame.ground_truth is None or frame.stamp not in estimates:
            continue
        distances = joint_errors(estimates[frame.stamp], frame.ground_truth)
        found = np.isfinite(distances)
        estimated += bool(found.any(axis=1).all())
        errors.extend(distances[found].tolist())
    return LiveResult(frames, estimated, float(np.mean(errors)) if errors else float('inf'))


def room_result(recording: Path) -> RoomResult:
    """Return which people the estimates in `recording` show, whatever their numbers are."""
    estimates = _read_estimates(recording)
    people = 0
    errors: list[float] = []
    for frame in open_recording(recording):
        if frame.ground_truth is None:
            continue
        people += len(frame.ground_truth.bodies)
        if frame.stamp not in estimates:
            continue
        joints = estimates[frame.stamp].joints
        found = estimates[frame.stamp].positions
        for body in select_joints(frame.ground_truth, joints):
            distances = np.linalg.norm(found - body, axis=-1)
            known = np.isfinite(distances).any(axis=1)
            nearest = min(np.nanmean(distances[known], axis=1), default=float('inf'))
            if nearest <= FOUND_WITHIN:
                errors.append(float(nearest))
    return RoomResult(people, len(errors), float(np.mean(errors)) if errors else float('inf'))


def _read_estimates(recording: Path) -> 'dict[int, Skeletons]':
    estimates: dict[int, Skeletons] = {}
    for message in read_messages(recording):
        if message.topic == SKELETONS_TOPIC:
            stamp, skeletons = read_skeletons(message.data)
            estimates[stamp] = skeletons
    return estimates


def summary(
    room: RoomResult,
    result: LiveResult,
    accuracies: dict[str, ModelAccuracy],
    files: Files,
    seconds: float,
) -> str:
    """Return the text that is printed at the end."""
    verdict = 'as good as expected' if result.passed else 'NOT as good as expected'
    rows = '\n'.join(
        f'{name:<22}{100 * accuracy.mean_error:>8.1f} cm{100 * accuracy.fraction:>14.1f} %'
        for name, accuracy in accuracies.items()
    )
    return f"""
In a furnished room, without a mask, the live node found {room.found} of {room.people} people.
Mean error of their joints, hidden ones included: {100 * room.mean_error:.1f} cm.

With masks, the live node estimated {result.estimated} of {result.frames} frames over ROS 2.
Mean error of its joints: {100 * result.mean_error:.1f} cm (limit: {100 * MOST_ERROR:.0f} cm).
This is {verdict}. The demonstration took {seconds:.0f} s.

{'model':<22}{'mean error':>11}{'within 10 cm':>16}
{rows}

A picture of the room:                  {files.room_picture}
Estimates of the node and ground truth: {files.live}
A picture of them:                      {files.picture}
The model that was trained:             {files.model}
"""


def _files(directory: Path) -> Files:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        msg = f'{directory}: cannot be created ({error.strerror}); choose another --directory'
        raise InputError(msg) from error
    names = (
        'room.mcap', 'room_live.mcap', 'room.png', 'room.log',
        'test.mcap', 'live.mcap', 'live.png', 'node.log',
        'training.mcap', 'model.npz', 'scores.json',
    )  # fmt: skip
    return Files(*(directory / name for name in names))


def _run_step(*words: object) -> None:
    """Run one `lsc_pose` command in this process; end with its status if it fails."""
    arguments = [str(word) for word in words]
    _say(f'\n$ lsc_pose {" ".join(arguments)}')
    status = command_line.main(arguments)
    if status:
        raise SystemExit(status)


def _evaluate(files: Files, model: Path) -> ModelAccuracy:
    _run_step('evaluate', model, files.test, '--json', files.scores)
    results = json.loads(files.scores.read_text(encoding='utf-8'))
    return ModelAccuracy(results['mean_error_m'], results['map'])


def _published_estimates(recording: Path, frames: int, *options: str) -> list[SerializedMessage]:
    """Publish a recording of `frames` frames and return the skeletons that the node publishes."""
    with _listener() as listener:
        _run_step('replay', recording, '--publish', '--wait-for', _START_TIMEOUT, *options)
        listener.wait_for_messages(frames, _END_TIMEOUT)
        return list(listener.received)


@contextmanager
def _listener() -> Iterator[Any]:
    """Subscribe to the skeletons of the node, and wait until it is found."""
    opened = load_with_ros('lsc_pose_ros.ros.playback.listener').open_listener
    with opened({SKELETONS_TOPIC: POINT_CLOUD}) as listener:
        if not listener.wait_for_publishers(_START_TIMEOUT):
            msg = f'pose_node did not advertise {SKELETONS_TOPIC} in {_START_TIMEOUT:g} s'
            raise InputError(msg)
        yield listener


@contextmanager
def _live_node(log_file: Path, model: Path, *parameters: str) -> Iterator[None]:
    """Run pose_node with `model` and other `parameters` in a separate process."""
    chosen = (f'model:={model}', *parameters)
    words = ['--ros-args', *(word for each in chosen for word in ('-p', each))]
    _say(f'\n$ pose_node {" ".join(words)}')
    with log_file.open('wb') as log:
        node = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, '-m', 'lsc_pose_ros.ros.node.main', *words],
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            yield
            if node.poll() is not None:
                msg = f'pose_node ended with status {node.returncode}; see {log_file}'
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
