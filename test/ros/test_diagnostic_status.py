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

"""What the node measures of itself, and what it makes of it; pure Python."""

import threading

import pytest

from lsc_pose_ros.ros.health.diagnostic_status import (
    _ORDINARY,
    _TROUBLES,
    Level,
    Stretch,
    condition,
)
from lsc_pose_ros.ros.health.measurements import LONGEST_LATENCY, Measurements, Measuring
from lsc_pose_ros.ros.health.stream_warnings import Counters

NOTHING = Measurements(0, 0, 0, [], {})
BUSY = Measurements(
    answers=30,
    failures=0,
    bodies=2,
    latencies=[number / 1000 for number in range(1, 31)],
    stages={'decode': [0.001] * 30, 'estimate': [0.004] * 29 + [0.010]},
)


def stretch(measured=BUSY, quiet=0.0, **gained):
    before = Counters(depth=1000, masks=900, pairs=900, replaced=3)
    usual = {'depth': 30, 'masks': 30, 'pairs': 30}
    changes = {
        name: getattr(before, name) + number for name, number in {**usual, **gained}.items()
    }
    return Stretch(1.0, quiet, before, before._replace(**changes), measured)


def test_all_is_well():
    found = condition(stretch())
    assert (found.level, found.message) == (Level.OK, 'answering')
    assert found.values['frames in (Hz)'] == '30.0'
    assert found.values['answers out (Hz)'] == '30.0'
    assert found.values['bodies'] == '2'
    assert found.values['latency p50 (ms)'] == '15.5'
    assert found.values['latency p95 (ms)'] == '28.6'
    assert found.values['decode p50 (ms)'] == '1.0'
    assert found.values['estimate p95 (ms)'] == '4.0'
    assert found.values['depth'] == '1030'
    assert found.values['camera infos'] == '0'


def test_rates_are_by_the_second():
    found = condition(stretch()._replace(seconds=2.0))
    assert (found.values['frames in (Hz)'], found.values['answers out (Hz)']) == ('15.0', '15.0')


def test_latencies_that_nobody_knows():
    found = condition(stretch(BUSY._replace(latencies=[])))
    assert found.values['latency p50 (ms)'] == found.values['latency p95 (ms)'] == 'unknown'
    assert found.level is Level.OK


def test_silence_is_stale():
    found = condition(stretch(NOTHING, quiet=4.0, depth=0, masks=0, pairs=0))
    assert (found.level, found.message) == (Level.STALE, 'no depth image for 4 s')


def test_a_slow_camera_is_not():
    waiting = condition(stretch(NOTHING, quiet=2.0, depth=0, masks=0, pairs=0))
    one_came = condition(stretch(NOTHING, depth=1, masks=0, pairs=0))
    assert waiting.level is one_came.level is Level.OK
    assert waiting.message == 'waiting'


def test_failures_are_errors():
    found = condition(stretch(BUSY._replace(answers=20, failures=10)))
    assert found.level is Level.ERROR
    assert '10 frames could not be answered' in found.message


def test_depth_without_answers():
    found = condition(stretch(NOTHING, masks=0, pairs=0))
    assert found.level is Level.WARN
    assert 'none can be answered' in found.message


def test_overload_is_told_beyond_a_few_frames():
    assert condition(stretch(replaced=1)).level is Level.OK
    found = condition(stretch(BUSY._replace(answers=10), replaced=20))
    assert (found.level, found.message) == (Level.WARN, 'images: 20 left out for newer ones')
    assert found.values['replaced'] == '23'


def test_missing_images_are_told_beyond_a_few():
    assert condition(stretch(missing=1)).level is Level.OK
    found = condition(stretch(missing=5))
    assert (found.level, found.message) == (Level.WARN, 'images: 5 missing by their stamps')


@pytest.mark.parametrize('name', ['lost', 'duplicates', 'late', 'rewinds'])
def test_whatever_else_is_left_out_is_told(name):
    found = condition(stretch(**{name: 2}))
    assert (found.level, found.message) == (Level.WARN, f'images: 2 {_TROUBLES[name]}')


def test_masks_slower_than_depth_are_no_trouble():
    assert condition(stretch(masks=10, pairs=10, unmatched_depth=20)).level is Level.OK


def test_every_counter_is_trouble_or_is_not():
    assert set(Counters._fields) == _ORDINARY ^ set(_TROUBLES)


def test_stages_are_timed_frame_by_frame():
    ticks = iter([1.0, 1.5, 2.0, 2.25, 3.0, 3.125])
    measuring = Measuring(now=lambda: next(ticks))
    for stage in ('decode', 'estimate', 'decode'):
        with measuring.stage(stage):
            pass
    assert measuring.take().stages == {'decode': [0.5, 0.125], 'estimate': [0.25]}
    assert measuring.take() == NOTHING


def test_stages_of_the_method_are_added_if_they_have_run():
    measuring = Measuring()
    measuring.add_stages({'window': 0.25, 'graph': 0.0})
    measuring.add_stages({'window': 0.5, 'graph': 0.125})
    assert measuring.take().stages == {'window': [0.25, 0.5], 'graph': [0.125]}


def test_a_stage_that_fails_is_not_timed():
    measuring = Measuring()
    with pytest.raises(ValueError, match='bad'), measuring.stage('decode'):
        raise ValueError('bad')  # noqa: EM101
    assert measuring.take().stages == {}


def test_only_comparable_latencies_count():
    measuring = Measuring()
    for latency in (0.02, -0.01, -1.0, LONGEST_LATENCY + 1, 3e8):
        measuring.answered(1, latency)
    measuring.failed()
    taken = measuring.take()
    assert (taken.answers, taken.failures) == (5, 1)
    assert taken.latencies == [0.02, 0.0]


def test_what_nobody_takes_does_not_grow():
    measuring = Measuring(capacity=10)
    for number in range(100):
        with measuring.stage('decode'):
            measuring.answered(1, number / 100)
    taken = measuring.take()
    assert len(taken.stages['decode']) == len(taken.latencies) == 10
    assert taken.latencies[-1] == 0.99


def test_nothing_is_lost_between_threads():
    measuring, taken = Measuring(), []

    def work():
        for _ in range(2000):
            with measuring.stage('decode'):
                measuring.answered(1, 0.0)

    workers = [threading.Thread(target=work) for _ in range(2)]
    for worker in workers:
        worker.start()
    while any(worker.is_alive() for worker in workers):
        taken.append(measuring.take())
    taken.append(measuring.take())
    assert sum(each.answers for each in taken) == 4000
