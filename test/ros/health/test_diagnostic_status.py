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

"""The measurements of the node and the status that is made from them."""

import threading

import pytest

from lsc_pose_ros.ros.health.diagnostic_status import (
    _NORMAL_COUNTERS,
    _PROBLEM_COUNTERS,
    Interval,
    Level,
    status_of,
)
from lsc_pose_ros.ros.health.measurements import (
    LONGEST_LATENCY,
    MeasurementCollector,
    Measurements,
)
from lsc_pose_ros.ros.health.stream_warnings import Counters

NOTHING = Measurements(0, 0, 0, [], {})
BUSY = Measurements(
    estimates=30,
    failures=0,
    bodies=2,
    latencies=[number / 1000 for number in range(1, 31)],
    stages={'decode': [0.001] * 30, 'estimate': [0.004] * 29 + [0.010]},
)


def interval(measured=BUSY, silence=0.0, **gained):
    before = Counters(depth=1000, masks=900, pairs=900, replaced=3)
    usual = {'depth': 30, 'masks': 30, 'pairs': 30}
    changes = {
        name: getattr(before, name) + number for name, number in {**usual, **gained}.items()
    }
    return Interval(1.0, silence, before, before._replace(**changes), measured)


def test_status_without_problems():
    found = status_of(interval())
    assert (found.level, found.message) == (Level.OK, 'estimating')
    assert found.values['frames in (Hz)'] == '30.0'
    assert found.values['estimates out (Hz)'] == '30.0'
    assert found.values['bodies'] == '2'
    assert found.values['latency p50 (ms)'] == '15.5'
    assert found.values['latency p95 (ms)'] == '28.6'
    assert found.values['decode p50 (ms)'] == '1.0'
    assert found.values['estimate p95 (ms)'] == '4.0'
    assert found.values['depth'] == '1030'
    assert found.values['camera infos'] == '0'


def test_rates_are_per_second():
    found = status_of(interval()._replace(seconds=2.0))
    assert (found.values['frames in (Hz)'], found.values['estimates out (Hz)']) == ('15.0', '15.0')


def test_unknown_latencies():
    found = status_of(interval(BUSY._replace(latencies=[])))
    assert found.values['latency p50 (ms)'] == found.values['latency p95 (ms)'] == 'unknown'
    assert found.level is Level.OK


def test_stream_without_depth_images_is_stale():
    found = status_of(interval(NOTHING, silence=4.0, depth=0, masks=0, pairs=0))
    assert (found.level, found.message) == (Level.STALE, 'no depth image for 4 s')


def test_slow_camera_is_not_stale():
    waiting = status_of(interval(NOTHING, silence=2.0, depth=0, masks=0, pairs=0))
    one_came = status_of(interval(NOTHING, depth=1, masks=0, pairs=0))
    assert waiting.level is one_came.level is Level.OK
    assert waiting.message == 'waiting'


def test_failures_are_errors():
    found = status_of(interval(BUSY._replace(estimates=20, failures=10)))
    assert found.level is Level.ERROR
    assert '10 frames could not be estimated' in found.message


def test_depth_images_without_estimates():
    found = status_of(interval(NOTHING, masks=0, pairs=0))
    assert found.level is Level.WARN
    assert 'none can be estimated' in found.message


def test_overload_is_reported_beyond_the_tolerated_fraction():
    assert status_of(interval(replaced=1)).level is Level.OK
    assert status_of(interval(depth=40, replaced=2)).level is Level.OK
    assert status_of(interval(depth=40, replaced=3)).level is Level.WARN
    found = status_of(interval(BUSY._replace(estimates=10), replaced=20))
    assert (found.level, found.message) == (Level.WARN, 'images: 20 replaced by newer ones')
    assert found.values['replaced'] == '23'


def test_missing_images_are_reported_beyond_the_tolerated_fraction():
    assert status_of(interval(missing=1)).level is Level.OK
    found = status_of(interval(missing=5))
    assert (found.level, found.message) == (Level.WARN, 'images: 5 missing by their stamps')


@pytest.mark.parametrize('name', ['lost', 'duplicates', 'late', 'rewinds'])
def test_all_other_problems_are_reported(name):
    found = status_of(interval(**{name: 2}))
    assert (found.level, found.message) == (Level.WARN, f'images: 2 {_PROBLEM_COUNTERS[name]}')


def test_masks_slower_than_depth_are_no_problem():
    assert status_of(interval(masks=10, pairs=10, unmatched_depth=20)).level is Level.OK


def test_each_counter_is_either_normal_or_a_problem():
    assert set(Counters._fields) == _NORMAL_COUNTERS ^ set(_PROBLEM_COUNTERS)


def test_stages_are_timed_for_each_frame():
    ticks = iter([1.0, 1.5, 2.0, 2.25, 3.0, 3.125])
    collector = MeasurementCollector(now=lambda: next(ticks))
    for stage in ('decode', 'estimate', 'decode'):
        with collector.stage(stage):
            pass
    assert collector.take().stages == {'decode': [0.5, 0.125], 'estimate': [0.25]}
    assert collector.take() == NOTHING


def test_stages_of_the_method_are_added_if_they_have_run():
    measurements = MeasurementCollector()
    measurements.add_stages({'window': 0.25, 'graph': 0.0})
    measurements.add_stages({'window': 0.5, 'graph': 0.125})
    assert measurements.take().stages == {'window': [0.25, 0.5], 'graph': [0.125]}


def test_stage_that_fails_is_not_timed():
    collector = MeasurementCollector()
    with pytest.raises(ValueError, match='bad'), collector.stage('decode'):
        raise ValueError('bad')  # noqa: EM101
    assert collector.take().stages == {}


def test_only_comparable_latencies_count():
    collector = MeasurementCollector()
    for latency in (0.02, -0.01, -1.0, LONGEST_LATENCY + 1, 3e8):
        collector.count_estimate(1, latency)
    collector.count_failure()
    taken = collector.take()
    assert (taken.estimates, taken.failures) == (5, 1)
    assert taken.latencies == [0.02, 0.0]


def test_measurements_that_nobody_takes_are_bounded():
    collector = MeasurementCollector(capacity=10)
    for number in range(100):
        with collector.stage('decode'):
            collector.count_estimate(1, number / 100)
    taken = collector.take()
    assert len(taken.stages['decode']) == len(taken.latencies) == 10
    assert taken.latencies[-1] == 0.99


def test_no_measurement_is_lost_between_threads():
    collector, taken = MeasurementCollector(), []

    def work():
        for _ in range(2000):
            with collector.stage('decode'):
                collector.count_estimate(1, 0.0)

    workers = [threading.Thread(target=work) for _ in range(2)]
    for worker in workers:
        worker.start()
    while any(worker.is_alive() for worker in workers):
        taken.append(collector.take())
    taken.append(collector.take())
    assert sum(each.estimates for each in taken) == 4000
