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

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tiny_model import tiny_model

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.options.frame_selection import pick, spread
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons, no_skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import save_model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.viz.report import contact_sheet as sheet
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame

FRAMES = 9
_SMALL = SyntheticSettings(frames=FRAMES, width=160, height=120, clip_length=3, people=2)


@pytest.fixture(scope='module')
def people() -> list[Frame]:
    return list(synthetic_frames(_SMALL))


@pytest.fixture(scope='module')
def recording(people: list[Frame], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('view') / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in people:
            writer.write_frame(frame)
    return path


@pytest.fixture(scope='module')
def answered(people: list[Frame], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording with skeletons on two topics, 10 and 20 cm to the side of the ground truth."""
    path = tmp_path_factory.mktemp('view') / 'answered.mcap'
    with RecordingWriter(path) as writer:
        for frame in people:
            writer.write_frame(frame)
            for topic, metres in (('/one/skeletons', 0.1), ('/two/skeletons', 0.2)):
                writer.write_skeletons(topic, frame.stamp, frame.frame_id, beside(frame, metres))
    return path


@pytest.fixture(scope='module')
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('view') / 'model.npz'
    save_model(path, tiny_model())
    return path


def beside(frame: Frame, metres: float) -> Skeletons:
    assert frame.ground_truth is not None
    offset = np.array([metres, 0, 0], np.float32)
    return frame.ground_truth._replace(positions=frame.ground_truth.positions + offset)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[DrawnFrame]:
    """The frames that are drawn on a sheet."""
    frames: list[DrawnFrame] = []

    def draw(given: list[DrawnFrame], title: str) -> object:
        frames.extend(given)
        return sheet.contact_sheet(given[:1], title)

    monkeypatch.setattr('lsc_pose_ros.cli.commands.view_command.contact_sheet', draw)
    return frames


def size_of(path: Path) -> tuple[int, int]:
    with Image.open(path) as image:
        assert image.format == 'PNG'
        return image.size


def refused(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    """Return the error message of the command, which ends with status 2."""
    assert main(['view', *map(str, words)]) == 2
    said = capsys.readouterr()
    assert said.out == ''
    assert len(said.err.splitlines()) == 1
    return said.err


def test_sheet_is_drawn_with_a_model(
    recording: Path, model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'sheet.png'
    words = ['view', str(recording), '-o', str(output), '--model', str(model), '--frames', '3']
    assert main(words) == 0
    assert capsys.readouterr() == (f'{output}: 3 frames, 3 of them with joints\n', '')
    width, height = size_of(output)
    assert width > height


def test_frames_are_estimated_with_the_model(
    recording: Path, model: Path, tmp_path: Path, drawn: list[DrawnFrame]
) -> None:
    words = ['view', str(recording), '-o', str(tmp_path / 'a.png'), '--model', str(model)]
    assert main([*words, '--at', '7', '2']) == 0
    assert [each.label for each in drawn] == ['frame 7', 'frame 2']
    for each in drawn:
        assert each.estimate is not None
        assert each.estimate.positions.shape == (2, 17, 3)
        assert each.settings == tiny_model().settings


def test_without_a_model_the_ground_truth_is_drawn(
    recording: Path, tmp_path: Path, drawn: list[DrawnFrame]
) -> None:
    assert main(['view', str(recording), '-o', str(tmp_path / 'a.png')]) == 0
    assert len(drawn) == FRAMES
    assert all(each.estimate is None and each.frame.ground_truth is not None for each in drawn)


def partly_labelled(frames: list[Frame], path: Path, labelled: set[int]) -> Path:
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(frames):
            truth = frame.ground_truth
            assert truth is not None
            if number not in labelled:
                truth = no_skeletons(truth.joints)
            writer.write_frame(frame._replace(ground_truth=truth))
    return path


def test_frames_with_labels_are_drawn_if_not_all_have_some(
    people: list[Frame],
    tmp_path: Path,
    drawn: list[DrawnFrame],
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = partly_labelled(people, tmp_path / 'some.mcap', {1, 4, 8})
    words = ['view', str(path), '-o', str(tmp_path / 'a.png'), '--frames', '3']
    assert main(words) == 0
    assert [each.label for each in drawn] == ['frame 1', 'frame 4', 'frame 8']
    assert '3 frames, 3 of them with joints' in capsys.readouterr().out
    drawn.clear()
    assert main([*words[:4], '--at', '3', '4']) == 0
    assert '2 frames, 1 of them with joints' in capsys.readouterr().out


def test_frames_are_drawn_if_no_label_is_known(
    people: list[Frame],
    tmp_path: Path,
    drawn: list[DrawnFrame],
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = partly_labelled(people, tmp_path / 'none.mcap', set())
    assert main(['view', str(path), '-o', str(tmp_path / 'a.png'), '--frames', '3']) == 0
    assert len(drawn) == 3
    assert '3 frames, 0 of them with joints' in capsys.readouterr().out


def test_frames_with_estimates_are_drawn_if_not_all_have_some(
    people: list[Frame], tmp_path: Path, drawn: list[DrawnFrame]
) -> None:
    path = tmp_path / 'a.mcap'
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(people):
            bare = frame._replace(ground_truth=None)
            writer.write_frame(bare)
            if number in {2, 3, 7}:
                writer.write_skeletons(
                    '/skeletons', frame.stamp, frame.frame_id, beside(frame, 0.1)
                )
    assert main(['view', str(path), '-o', str(tmp_path / 'a.png'), '--frames', '2']) == 0
    assert len(drawn) == 2
    assert {each.label for each in drawn} <= {'frame 2', 'frame 3', 'frame 7'}
    assert all(each.estimate is not None for each in drawn)


@pytest.mark.parametrize(('topic', 'metres'), [('/one/skeletons', 0.1), ('/two/skeletons', 0.2)])
def test_recorded_skeletons_are_drawn(
    answered: Path, tmp_path: Path, drawn: list[DrawnFrame], topic: str, metres: float
) -> None:
    words = ['view', str(answered), '-o', str(tmp_path / 'a.png'), '--skeletons-topic', topic]
    assert main([*words, '--at', '4', '5']) == 0
    for each in drawn:
        assert each.estimate is not None
        wanted = beside(each.frame, metres)
        np.testing.assert_allclose(each.estimate.positions, wanted.positions)


def test_one_topic_of_skeletons_is_found_by_its_name(
    people: list[Frame], tmp_path: Path, drawn: list[DrawnFrame]
) -> None:
    path = tmp_path / 'a.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:2]:
            writer.write_frame(frame)
        first = people[0]
        writer.write_skeletons(
            '/pose_node/skeletons', first.stamp, first.frame_id, beside(first, 0.1)
        )
    assert main(['view', str(path), '-o', str(tmp_path / 'a.png')]) == 0
    assert [each.estimate is not None for each in drawn] == [True, False]


def test_several_topics_of_skeletons_are_not_guessed_among(
    answered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refused(capsys, answered, '-o', tmp_path / 'a.png')
    assert 'several topics have skeletons: /one/skeletons, /two/skeletons' in said
    assert '--skeletons-topic' in said


def test_wrong_topic_of_skeletons_is_refused(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = (recording, '-o', tmp_path / 'a.png', '--skeletons-topic')
    assert '/mask has no skeletons' in refused(capsys, *words, '/mask')


def test_model_of_the_package_estimates_the_skeletons_to_draw(
    people: list[Frame],
    recording: Path,
    model: Path,
    shipped: Path,
    tmp_path: Path,
    drawn: list[DrawnFrame],
) -> None:
    bare = tmp_path / 'bare.mcap'
    with RecordingWriter(bare) as writer:
        for frame in people[:3]:
            writer.write_frame(frame._replace(ground_truth=None))
    words = ['view', str(bare), '-o', str(tmp_path / 'a.png')]
    assert main(words) == 0  # no model comes with the package
    assert [each.estimate for each in drawn] == [None] * 3
    drawn.clear()
    (shipped / 'default.npz').write_bytes(model.read_bytes())
    assert main(words) == 0
    assert [each.estimate is not None for each in drawn] == [True] * 3
    drawn.clear()
    words[1] = str(recording)  # true skeletons are enough to look at
    assert main(words) == 0
    assert all(each.estimate is None for each in drawn)
    drawn.clear()
    assert main([*words, '--model', 'default', '--frames', '2']) == 0
    assert [each.estimate is not None for each in drawn] == [True] * 2


def test_stages_with_the_model_of_the_package(
    recording: Path,
    model: Path,
    shipped: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ['view', str(recording), '-o', str(tmp_path / 'stages'), '--stages', '0']
    assert main(words) == 0
    without = len(capsys.readouterr().out.splitlines())
    (shipped / 'default.npz').write_bytes(model.read_bytes())
    assert main(words) == 0
    assert len(capsys.readouterr().out.splitlines()) == 10 > without


def test_stages_into_a_folder(
    recording: Path, model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ['view', str(recording), '-o', str(tmp_path / 'stages'), '--model', str(model)]
    assert main([*words, '--stages', '3', '--body', '2']) == 0
    paths = [Path(line) for line in capsys.readouterr().out.splitlines()]
    assert len(paths) == 10
    assert all(size_of(path) for path in paths[:-1])
    assert json.loads(paths[-1].read_text())['body'] == 2


def test_stages_onto_one_sheet(recording: Path, tmp_path: Path) -> None:
    output = tmp_path / 'stages.png'
    assert main(['view', str(recording), '-o', str(output), '--stages', '0']) == 0
    assert size_of(output)[0] > 500


def test_what_cannot_be_drawn_is_refused_with_a_reason(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'a.png'
    assert 'its name must end in .png' in refused(capsys, recording, '-o', tmp_path / 'a.jpg')
    nowhere = tmp_path / 'no' / 'a.png'
    assert 'does not exist; create it first' in refused(capsys, recording, '-o', nowhere)
    assert 'too many' in refused(capsys, recording, '-o', output, '--frames', 201)
    assert '--body needs --stages' in refused(capsys, recording, '-o', output, '--body', 1)
    beyond = refused(capsys, recording, '-o', output, '--at', 3, 9)
    assert f'people.mcap has no frame 9; its {FRAMES} frames are numbered from 0 to 8' in beyond
    body = refused(capsys, recording, '-o', output, '--stages', 0, '--body', 7)
    assert 'frame 0: the mask has no body 7; the bodies in it: 1, 2' in body
    assert 'none.mcap' in refused(capsys, tmp_path / 'none.mcap', '-o', output)
    assert 'people.mcap' in refused(capsys, recording, '-o', output, '--model', recording)
    assert not output.exists()


def test_negative_frame_number_is_refused(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(['view', str(recording), '-o', 'a.png', '--stages', '-1'])
    assert end.value.code == 2
    assert 'frames are counted from 0' in capsys.readouterr().err


@pytest.mark.parametrize('total', [1, 5, 6, 7, 23, 24, 25, 100, 1000])
def test_spread_takes_evenly_from_any_number(people: list[Frame], total: int) -> None:
    chosen = [number for number, _ in spread([people[0]] * total, 6)]
    assert len(chosen) == min(6, total)
    assert chosen == sorted(set(chosen))
    gaps = np.diff([-0.5, *chosen, total - 0.5])
    assert gaps[1:-1].max(initial=0) <= 1.5 * total / 6 + 1
    assert max(gaps[0], gaps[-1]) <= total / 6 + 1


def test_spread_of_nothing_is_nothing() -> None:
    assert spread([], 3) == []


def test_pick_reads_no_further_than_needed(people: list[Frame]) -> None:
    frames = iter(people)
    assert [number for number, _ in pick(frames, [2, 0, 2], 'here')] == [2, 0, 2]
    assert next(frames) is people[3]
    with pytest.raises(InputError, match='here has no frame 9'):
        pick(people, [9, 0], 'here')
