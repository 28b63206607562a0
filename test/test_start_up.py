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

"""All kernels are compiled at start-up, and none later.

Each test is a separate process, because kernels that another test compiled would hide a gap.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import COMPILING_PATIENCE

import lsc_pose_ros
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

COUNT = """
import sys

from numba.core.dispatcher import Dispatcher

def compiled():
    \"\"\"Return the compiled or loaded kernels with the types of their arguments.\"\"\"
    modules = [module for name, module in sys.modules.items() if name.startswith('lsc_pose_ros')]
    kernels = [each for m in modules for each in vars(m).values() if isinstance(each, Dispatcher)]
    return {f'{k.__module__}.{k.__name__}{types}' for k in kernels for types in k.signatures}
"""

LIVE = """
import json

import numpy as np

from lsc_pose_ros.data_types.camera import Lens
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.estimation.warm_up import warm_up
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.messages.image_pixels import depth_of, labels_of
from lsc_pose_ros.messages.parse import StampedCompressedImage, StampedImage

def image(pixels, encoding, padding=0):
    pixels = np.pad(pixels, ((0, 0), (0, padding)))
    layout = ImageLayout(
        encoding, len(pixels), pixels.shape[1] - padding, pixels.strides[0],
        pixels.dtype.byteorder == '>',
    )
    return StampedImage(0, '', layout, np.frombuffer(pixels.tobytes(), np.uint8))

def compressed(pixels, codec):
    form, data = encode_compressed_depth(pixels, codec)
    return StampedCompressedImage(0, '', form, np.frombuffer(data, np.uint8))

def messages(frame):
    millimetres = np.rint(1000 * frame.depth).astype('<u2')
    metres = frame.depth.astype('<f4')
    numbers = np.maximum(frame.labels, 0)
    masks = [
        image(numbers.astype('u1'), 'mono8'), image(numbers.astype('u1'), 'mono8', 3),
        image(numbers.astype('<u2'), '16UC1'), image(numbers.astype('>i4'), '32SC1'),
    ]
    depths = [
        image(millimetres, '16UC1'), image(millimetres.astype('>u2'), '16UC1', 3),
        image(metres, '32FC1'), image(metres, '32FC1', 5),
        compressed(millimetres, 'png'), compressed(millimetres, 'rvl'),
    ]
    lenses = [
        None, Lens('plumb_bob', (0.1, 0.1)), Lens('equidistant', (0.1, 0.0, 0.0, 0.0)),
        Lens('rational_polynomial', (0.1,) * 8),
    ]
    for number, (depth, mask) in enumerate(zip(depths, masks + masks)):
        yield depth, mask, frame.camera._replace(lens=lenses[number % 4])

model, recording, graph = sys.argv[1], sys.argv[2], bool(int(sys.argv[3]))
sent = [message for frame in open_recording(recording) for message in messages(frame)]
estimator = Estimator(load_model(model), graph=graph)
warm_up(estimator)
before = compiled()
bodies_found = [0, 0, 0]
for depth, mask, camera in sent:
    depth, labels = depth_of(depth), labels_of(mask, 0)
    skeletons = estimator.estimate(depth, labels, camera)
    bodies_found[np.isfinite(skeletons.positions[:, :, 0]).any(axis=1).sum()] += 1
for _ in range(2):
    labels[:] = -1
    estimator.estimate(depth, labels, camera)
    labels[100, 100] = 1
later = sorted(compiled() - before)
print(json.dumps({'before': len(before), 'later': later, 'bodies': bodies_found}))
"""

ALL = """
import json

import numpy as np

from lsc_pose_ros import compile

assert compile.main([]) == 0
before = compiled()

from lsc_pose_ros.cli.main import main
from lsc_pose_ros.messages.codecs.compressed_depth import (
    decode_compressed_depth,
    encode_compressed_depth,
)

recording, model = sys.argv[1] + '/people.mcap', sys.argv[1] + '/model.npz'
for words in (
    ['synth', recording, '--frames', '9', '--sensor', 'azure', '--fps', '15', '--background'],
    ['synth', recording, '--frames', '60'],
    ['train', recording, '-o', model, '--trees', '1', '--depth', '3', '--feature', '2dsc'],
    ['train', recording, '-o', model, '--trees', '1', '--depth', '3', '--feature', 'dcf'],
    ['train', recording, '-o', model, '--trees', '1', '--depth', '3', '--body-yaw'],
    ['evaluate', model, recording],
    ['train', recording, '-o', model, '--trees', '1', '--depth', '3'],
    ['evaluate', model, recording],
    ['evaluate', model, recording, '--no-graph'],
):
    assert main(words) == 0
form, data = encode_compressed_depth(np.ones((3, 4), np.uint16), 'rvl')
assert (decode_compressed_depth(data, form) == 1).all()
print(json.dumps({'before': len(before), 'later': sorted(compiled() - before)}))
"""


def run(code: str, *words: object) -> list[str]:
    paths = [str(Path(lsc_pose_ros.__file__).parents[1]), os.environ.get('PYTHONPATH', '')]
    done = subprocess.run(
        [sys.executable, '-c', code, *map(str, words)],
        env=os.environ | {'PYTHONPATH': os.pathsep.join(filter(None, paths))},
        check=False,
        capture_output=True,
        text=True,
        timeout=COMPILING_PATIENCE,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a recording of two frames: one person, and two people."""
    path = tmp_path_factory.mktemp('start_up') / 'frames.mcap'
    with RecordingWriter(path) as writer:
        for people in (1, 2):
            for frame in synthetic_frames(SyntheticSettings(frames=1, people=people, seed=3)):
                writer.write_frame(frame._replace(stamp=frame.stamp + people))
    return path


@pytest.mark.parametrize('graph', [True, False])
def test_no_frame_compiles_anything_after_the_warm_up(
    *, graph: bool, small_model_file: Path, recording: Path
) -> None:
    report = json.loads(run(COUNT + LIVE, small_model_file, recording, int(graph))[-1])
    assert report['bodies'] == [0, 6, 6]
    assert report['before'] >= 10
    assert report['later'] == []


def test_model_with_body_yaws_is_warmed_up_completely(
    body_yaw_model_file: Path, recording: Path
) -> None:
    report = json.loads(run(COUNT + LIVE, body_yaw_model_file, recording, 1)[-1])
    assert report['bodies'] == [0, 6, 6]
    assert report['later'] == []


def test_no_command_compiles_anything_after_compile(tmp_path: Path) -> None:
    message, *_, last = run(COUNT + ALL, tmp_path)
    assert re.fullmatch(r'all kernels ready in \d+\.\d s \(kept in .*\)', message)
    report = json.loads(last)
    assert report['before'] >= 15
    assert report['later'] == []
