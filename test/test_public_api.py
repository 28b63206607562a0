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

"""The public interface: what `import lsc_pose_ros` offers, and the examples that use it."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lsc_pose_ros
from lsc_pose_ros import (
    Estimator,
    Frame,
    FrameSettings,
    InputError,
    Model,
    load_model,
    open_recording,
)
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.model_io.model_file import save_model

ROOT = Path(__file__).parents[1]

# Libraries that only estimation, recordings or pictures need.
HEAVY = {'PIL', 'matplotlib', 'mcap', 'numba', 'numpy', 'rclpy', 'rosbags', 'sqlite3', 'yaml'}


def loaded_by(code: str) -> set[str]:
    """Run `code` in another Python; return the modules that it has imported."""
    program = f'import json, sys\n{code}\nprint(json.dumps(sorted(sys.modules)))'
    done = subprocess.run(
        [sys.executable, '-c', program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


def examples(document: str) -> list[str]:
    """Return the Python examples of a document."""
    text = (ROOT / document).read_text(encoding='utf-8')
    return re.findall(r'^```python\n(.*?)^```', text, re.MULTILINE | re.DOTALL)


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory, people: list[Frame]) -> Path:
    """Return a folder with people.mcap, a recording of three frames."""
    folder = tmp_path_factory.mktemp('examples')
    with RecordingWriter(folder / 'people.mcap') as writer:
        for frame in people[:3]:
            writer.write_frame(frame)
    return folder


def test_import_loads_no_library() -> None:
    assert loaded_by('import lsc_pose_ros') & HEAVY == set()


def test_data_types_load_neither_numba_nor_a_bag_library() -> None:
    loaded = loaded_by('from lsc_pose_ros import JOINT_NAMES, Frame, Intrinsics, Skeletons')
    assert 'numpy' in loaded
    assert loaded & HEAVY == {'numpy'}


@pytest.mark.parametrize('name', lsc_pose_ros.__all__)
def test_public_name_is_there_and_listed(name: str) -> None:
    assert getattr(lsc_pose_ros, name) is not None
    assert name in dir(lsc_pose_ros)


@pytest.mark.parametrize('name', lsc_pose_ros.__all__)
def test_public_name_is_documented(name: str) -> None:
    value = getattr(lsc_pose_ros, name)
    assert not callable(value) or value.__doc__
    page = (ROOT / 'docs' / 'python.md').read_text(encoding='utf-8')
    assert f'`{name}' in page


def test_star_import_gives_the_public_names() -> None:
    names: dict[str, object] = {}
    exec('from lsc_pose_ros import *', names)  # noqa: S102 - a statement of this test
    assert set(lsc_pose_ros.__all__) <= set(names)


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'open_frames'"):
        _ = lsc_pose_ros.open_frames  # type: ignore[attr-defined]


@pytest.mark.parametrize('document', ['README.md', 'docs/python.md'])
def test_examples_run_as_they_are_written(
    document: str,
    recording: Path,
    small_model: Model,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    save_model(recording / 'model.npz', small_model)
    monkeypatch.chdir(recording)
    assert examples(document)
    for number, example in enumerate(examples(document)):
        code = compile(example, f'{document}, example {number}', 'exec')
        exec(code, {'__name__': 'example'})  # noqa: S102 - the repository's own documents
        printed = capsys.readouterr().out
        assert printed
        for expected in re.findall(r'^print\(.*\)  # (.+)$', example, re.MULTILINE):
            assert f'{expected}\n' in printed


def test_example_estimates_every_frame_of_the_recording(
    recording: Path, small_model: Model
) -> None:
    estimator = Estimator(small_model)
    for frame in open_recording(recording / 'people.mcap'):
        skeletons = estimator.estimate(frame.depth, frame.labels, frame.camera)
        assert np.isfinite(skeletons.positions).all()
        assert [lsc_pose_ros.JOINT_NAMES[joint] for joint in skeletons.joints[:2]] == [
            'head',
            'neck',
        ]


def test_models_of_the_package_are_loaded_by_name(shipped: Path, small_model: Model) -> None:
    save_model(shipped / 'front.npz', small_model)
    assert load_model('front').provenance == small_model.provenance
    with pytest.raises(InputError, match='its models are front'):
        load_model('back')


def test_default_model_estimates_all_joints() -> None:
    assert len(load_model('default').joints) == len(JOINT_NUMBERS)


@pytest.mark.parametrize('model', [None, 3, b'default', Path])
def test_model_of_another_type_is_refused(model: object) -> None:
    with pytest.raises(InputError, match=r'must be a path or the name .*: default, front'):
        load_model(model)


def test_arguments_of_a_recording_are_checked(recording: Path) -> None:
    path = recording / 'people.mcap'
    with pytest.raises(InputError, match='must be a path, but is of type NoneType'):
        open_recording(None)
    with pytest.raises(InputError, match=r'topics is of type str.*Topics\(depth='):
        open_recording(path, '/depth/image')
    with pytest.raises(InputError, match='settings is of type int'):
        open_recording(path, settings=255)


@pytest.mark.parametrize(
    ('settings', 'reason'),
    [
        (
            {'segmentation': 'nearst'},
            "segmentation cannot be 'nearst'; it must be auto or ",
        ),
        (
            {'mask_background': '255'},
            "mask_background cannot be '255'; it must be of type integer",
        ),
        ({'mask_background': 1.5}, 'mask_background cannot be 1.5'),
        ({'mask_background': 65536}, 'mask_background cannot be 65536'),
        ({'sync_slop': True}, 'sync_slop cannot be True'),
    ],
)
def test_settings_of_a_recording_are_checked(
    recording: Path, settings: dict[str, Any], reason: str
) -> None:
    with pytest.raises(InputError, match=reason):
        open_recording(recording / 'people.mcap', settings=FrameSettings(**settings))


def test_settings_of_other_types_are_converted(recording: Path) -> None:
    settings: dict[str, Any] = {
        'rectified': True,
        'sync_slop': 0,
        'mask_background': np.uint8(0),
    }
    reader = open_recording(recording / 'people.mcap', settings=FrameSettings(**settings))
    assert sum(len(frame.labels) > 0 for frame in reader) == 3
