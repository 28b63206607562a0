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
"""What the server of the page answers and refuses, and how labels are converted."""

import signal
import sys
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.annotation.frame_labels import (
    BEFORE,
    FARTHEST,
    SURFACE,
    USUAL,
    from_json,
    joint_at,
    labels_of,
    skeletons_from,
    with_pixels,
)
from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.visibility import HIDDEN, SEEN, UNKNOWN
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.sources.keypoints import SURFACE_TO_JOINT

sys.path.insert(0, str(Path(__file__).parent))
from annotation_program import AnnotationProgram
from annotation_requests import ask, keep

HEAD = {'head': {'position': [0.1, 0.2, 2.0], 'hidden': False}}


def bodies(number: int = 1, joints: object = HEAD) -> list[dict[str, object]]:
    return [{'number': number, 'joints': joints}]


@pytest.fixture(scope='module')
def recording(tmp_path_factory, simple_frames):
    """A recording of ten labelled frames."""
    path = tmp_path_factory.mktemp('annotation') / 'boxes.mcap'
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame)
    return path


@pytest.fixture(scope='module')
def program(recording):
    """The command on the recording, for requests that change nothing."""
    program = AnnotationProgram(recording, recording.with_name('labelled.mcap'))
    yield program
    program.end(signal.SIGINT)


def test_the_labels_of_the_recording_are_the_beginning(program, simple_frames) -> None:
    status, frame = ask(program, 'GET', '/frame/4')
    assert status == 200
    truth = simple_frames[4].ground_truth
    assert [body['number'] for body in frame['bodies']] == truth.bodies.tolist()
    for row, body in enumerate(frame['bodies']):
        for column, number in enumerate(truth.joints.tolist()):
            joint = body['joints'].get(JOINT_NAMES[number])
            if np.isnan(truth.positions[row, column]).any():
                assert joint is None
            else:
                assert joint['position'] == pytest.approx(truth.positions[row, column].tolist())


@pytest.mark.parametrize(
    ('headers', 'path'),
    [
        ({'X-Token': ''}, '/frame/0'),
        ({'X-Token': 'wrong'}, '/recording'),
        ({'Host': 'evil.example:80'}, '/frame/0'),
        ({'X-Token': ''}, '/'),
    ],
)
def test_strangers_are_refused(program, headers, path) -> None:
    assert ask(program, 'GET', path, **headers)[0] == 403
    assert ask(program, 'POST', '/keep/0', {'bodies': []}, **headers)[0] == 403


@pytest.mark.parametrize(
    ('path', 'content', 'word'),
    [
        ('/keep/99', {'bodies': []}, 'no frame 99'),
        ('/keep/0', {'bodies': 3}, 'bodies'),
        ('/keep/0', {'bodies': bodies(joints={'tail': HEAD['head']})}, 'tail'),
        ('/keep/0', {'bodies': bodies(number=70_000)}, 'number'),
        ('/keep/x', {'bodies': []}, 'number'),
        ('/keep/0', [], 'object'),
        ('/place/0', {'pixel': [1]}, 'pixel'),
        ('/place/0', {'pixel': [1, 2], 'body': 9, 'joint': 'head'}, 'body 9'),
        ('/place/0', {'pixel': [1, 2], 'body': 1, 'joint': 'tail'}, 'tail'),
        ('/place/0', {'pixel': [1, 2], 'depth': 999}, 'the depth must be 0.1 to 100 m'),
        ('/keep/0', {'bodies': bodies(joints={'head': {'position': [0, 0, 999]}})}, '100 m'),
        ('/finish', {}, 'no frame is done'),
    ],
)
def test_a_wrong_request_gets_a_sentence(program, path, content, word) -> None:
    status, answer = ask(program, 'POST', path, content)
    assert status == 400
    assert word in answer['error']


def test_ctrl_c_ends_with_one_line_and_keeps_all(recording, tmp_path) -> None:
    program = AnnotationProgram(recording, tmp_path / 'labelled.mcap')
    assert keep(program, 2, bodies())[0] == 200
    status, _, err = program.end(signal.SIGINT)
    assert status == 130
    assert len(err.splitlines()) == 1
    program = AnnotationProgram(recording, tmp_path / 'labelled.mcap')
    try:
        assert ask(program, 'GET', '/recording')[1]['done'] == [n == 2 for n in range(10)]
        assert ask(program, 'GET', '/frame/2')[1]['bodies'][0]['joints'].keys() == {'head'}
    finally:
        program.end(signal.SIGINT)


@pytest.mark.parametrize(
    'wrong',
    [
        None,
        [1],
        bodies() * 2,
        bodies() * 100,
        bodies(-1),
        bodies(number=True),
        bodies(joints=[]),
        bodies(joints={'head': {'position': [0, 0]}}),
        bodies(joints={'head': {'position': [0, 0, 0]}}),
        bodies(joints={'head': {'position': [0, 0, float('nan')]}}),
        bodies(joints={'head': {'position': [0, 0, 2 * FARTHEST]}}),
        bodies(joints={'head': {'position': ['0', 0, 1]}}),
        bodies(joints={'head': 3}),
    ],
)
def test_wrong_labels_are_refused(wrong) -> None:
    with pytest.raises(InputError):
        from_json(wrong)


def test_labels_are_the_same_after_each_conversion(simple_frames) -> None:
    frame = simple_frames[3]
    labels = from_json(with_pixels(labels_of(frame.ground_truth), frame.camera))
    found, truth = skeletons_from(labels), frame.ground_truth
    assert found.bodies.tolist() == truth.bodies.tolist()
    np.testing.assert_allclose(found.positions[:, truth.joints], truth.positions, rtol=1e-6)
    known = np.isfinite(found.positions).all(axis=-1)
    assert known.sum() == np.isfinite(truth.positions).all(axis=-1).sum()
    np.testing.assert_array_equal(found.visibility, np.where(known, SEEN, UNKNOWN))
    labels[1].hidden[JOINT_NUMBERS['head']] = True
    hidden = skeletons_from(from_json(with_pixels(labels, frame.camera)))
    assert (hidden.visibility == HIDDEN).sum() == 1


def test_a_joint_is_behind_the_surface_or_as_deep_as_before(simple_frames) -> None:
    frame = simple_frames[0]
    hip, nowhere = JOINT_NUMBERS['l_hip'], np.full(3, np.nan)
    before = np.array([0.0, 0.0, 3.0])
    on_body = joint_at((14.0, 20.0), hip, frame, before)
    assert on_body.depth_from == SURFACE
    behind = frame.depth[20, 14] + SURFACE_TO_JOINT[hip]
    assert on_body.position[2] == pytest.approx(behind, abs=1e-6)
    camera = frame.camera
    expected = [(14 - camera.cx) / camera.fx, (20 - camera.cy) / camera.fy]
    np.testing.assert_allclose(on_body.position[:2] / on_body.position[2], expected, rtol=1e-5)
    # On the wall between the bodies, and outside of the image.
    for pixel in ((29.0, 20.0), (-500.0, 20.0)):
        beside = joint_at(pixel, hip, frame, before)
        assert (beside.position[2], beside.depth_from) == (pytest.approx(3.0), BEFORE)
        guess = joint_at(pixel, hip, frame, nowhere)
        median = np.median(frame.depth[frame.depth > 0])
        assert (guess.position[2], guess.depth_from) == (pytest.approx(median), USUAL)
    empty = frame._replace(depth=np.zeros_like(frame.depth))
    assert joint_at((14.0, 20.0), hip, empty, before).position[2] == pytest.approx(3.0)
    assert np.isfinite(joint_at((14.0, 20.0), hip, empty, nowhere).position).all()
    # Without any mask, each surface may be one of a body.
    alone = frame._replace(labels=np.full_like(frame.labels, NO_BODY))
    wall = joint_at((29.0, 20.0), hip, alone, before)
    assert wall.position[2] == pytest.approx(4.0 + SURFACE_TO_JOINT[hip])


def test_frames_come_in_any_order(simple_frames) -> None:
    store = FrameStore(simple_frames)
    assert len(store) == len(simple_frames)
    for number in (7, 0, 9, 3):
        np.testing.assert_array_equal(store[number].depth, simple_frames[number].depth)
        np.testing.assert_array_equal(store[number].labels, simple_frames[number].labels)
        assert store[number].stamp == simple_frames[number].stamp


def test_each_third_frame_is_stored_and_knows_its_number(simple_frames) -> None:
    store = FrameStore(simple_frames, every=3)
    assert store.numbers == [0, 3, 6, 9]
    assert store.all_stamps == [frame.stamp for frame in simple_frames]
    for at, number in enumerate(store.numbers):
        assert store.stamps[at] == store[at].stamp == simple_frames[number].stamp
        np.testing.assert_array_equal(store[at].depth, simple_frames[number].depth)
