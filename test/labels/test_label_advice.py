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

"""What the check of labels tells and advises, and what `lsc_pose label` refuses."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / 'bags'))

from label_recordings import pose, seconds, stamps, write_recording

from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.output.label_check import label_advice, label_facts, label_results
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.labels.checks.mirroring import SideReport
from lsc_pose_ros.labels.checks.study import LabelReport
from lsc_pose_ros.labels.checks.timing import Lag


def report(difference=0.05, lag=None, sides=(100, 0.0, 0.0), **problems):
    """A report of 1000 joints."""
    found = LabelReport(
        frames=50,
        labelled_frames=50,
        joints=1000,
        lag=lag,
        sides=SideReport(*sides),
        difference=difference,
        model='default.npz',
    )
    found.problems.update(problems)
    return found


LATE = Lag(-2.0, -0.066, 0.2)


def test_labels_in_another_place_have_one_advice():
    """Centimetres that are taken for metres."""
    found = report(difference=449.323, lag=LATE, outside=729, deep=258)
    assert label_advice(found) == [
        'the joints are 449 m from the estimates of the model: check --scale and --extrinsic'
    ]
    facts = label_facts(found)
    assert facts['model'].endswith('is 449 m')
    assert facts['time'] == 'no lag between labels and depth was found'
    assert not label_results('people.mcap', found)['lag_found']


def test_labels_near_the_estimates_have_an_advice_for_each_fault():
    advice = label_advice(report(difference=0.45, lag=LATE, outside=100, deep=30))
    assert len(advice) == 3
    assert '--time-offset -0.066' in advice[0]
    assert '--drop outside' in advice[1]
    assert '--drop deep' in advice[2]


def test_most_joints_are_not_advised_to_be_dropped():
    (advice,) = label_advice(report(outside=729))
    assert advice.startswith('72.9 % of the joints are outside of the mask')
    assert '--drop' not in advice
    assert '--extrinsic' in advice


def test_mirrored_labels_are_far_away_only_because_of_that():
    """A person 1.1 m beside the axis of the camera."""
    (advice,) = label_advice(report(difference=2.2, sides=(100, 0.0, 0.95), outside=900))
    assert '--mirror x' in advice


@pytest.mark.parametrize(
    ('metres', 'said'), [(0.0456, '4.6 cm'), (0.999, '99.9 cm'), (1.234, '1.23 m')]
)
def test_distances_are_in_metres_from_one_metre_on(metres, said):
    assert label_facts(report(difference=metres))['model'].endswith(f'is {said}')


def test_a_lag_is_told_only_if_it_is_found():
    little = Lag(0.1, 0.002, 0.0)
    assert label_facts(report(lag=little))['time'] == 'no lag between labels and depth was found'
    found = label_facts(report(lag=LATE))['time']
    assert found.startswith('labels are 2.0 frames (0.066 s) late')
    assert 'too little moves' in label_facts(report())['time']


def refused(capsys, *words):
    assert main(['label', *map(str, words)]) == 2
    return capsys.readouterr().err


@pytest.mark.parametrize(
    'options',
    [
        ('--drop', 'before'), ('--correct-lag',), ('--mirror', 'names'), ('--time-offset', '1'),
        ('--joints', 'azure'), ('--topic', '/markers'),
    ],
)  # fmt: skip
def test_options_without_a_source_are_not_ignored(tmp_path, capsys, options):
    said = refused(capsys, tmp_path / 'any.mcap', '--check', *options)
    assert f'{options[0]} needs -o and --from' in said
    assert '--from skeletons' in said


def test_labels_of_the_recording_itself_are_a_source(tmp_path, capsys):
    words = (tmp_path / 'any.mcap', '-o', tmp_path / 'dropped.mcap', '--drop', 'before')
    said = refused(capsys, *words)
    assert 'name the source of the labels with --from' in said
    assert '--from skeletons takes the labels that the recording has' in said


def test_bodies_on_no_mask_point_to_place_and_unit(tmp_path, capsys):
    recording = write_recording(tmp_path / 'depth.mcap')
    table = tmp_path / 'joints.csv'
    rows = ['stamp,joint,x,y,z']
    for stamp in stamps():
        for name, joint in zip(JOINT_NAMES, pose(seconds(stamp)), strict=True):
            rows.append(f'{stamp},{name},{joint[0] + 9},{joint[1]},{joint[2]}')
    table.write_text('\n'.join(rows))
    output = tmp_path / 'labelled.mcap'
    said = refused(capsys, recording, '-o', output, '--from', 'csv', '--source', table)
    assert 'none of the 5 frames got a label: 5 whose bodies no mask shows' in said
    for remedy in ('--extrinsic', '/tf', '--scale'):
        assert remedy in said
