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


"""States are logged when they change, and not too often."""

from test_throttled_log import Log

from lsc_pose_ros.ros.health.state_log import StateLog


def test_states_are_logged_when_they_change() -> None:
    log, time = Log(), [0.0]
    states = StateLog(log, 5.0, lambda: time[0], burst=1)
    for step, text in enumerate(['raw', 'raw', 'raw', 'rectified', 'rectified']):
        time[0] = 4.0 * step
        states.update('camera', text)
        states.update('roll', 'upright')
    assert log.lines == [('info', 'raw'), ('info', 'upright'), ('info', 'rectified')]


def test_states_that_change_each_frame_are_logged_once_in_a_period() -> None:
    log, time = Log(), [0.0]
    states = StateLog(log, 5.0, lambda: time[0], burst=1)
    for step in range(11):
        time[0] = step * 1.0
        states.update('camera', f'camera {step}')
    assert [text for _, text in log.lines] == ['camera 0', 'camera 5', 'camera 10']


def test_last_state_is_logged_even_if_it_came_too_soon() -> None:
    log, time = Log(), [0.0]
    states = StateLog(log, 5.0, lambda: time[0], burst=1)
    for step, text in enumerate(['masks', 'no masks', 'no masks', 'no masks']):
        time[0] = step * 2.0
        states.update('bodies', text)
    assert [text for _, text in log.lines] == ['masks', 'no masks']


def test_a_few_changes_are_logged_at_once() -> None:
    """A segmentation that begins and ends within a second is told of, whatever comes later."""
    log, time = Log(), [0.0]
    states = StateLog(log, 5.0, lambda: time[0])
    for step, text in enumerate(['people', 'masks', 'people', 'masks', 'people']):
        time[0] = 0.1 * step
        states.update('bodies', text)
    assert [text for _, text in log.lines] == ['people', 'masks', 'people']
    time[0] = 30.0
    for text in ('masks', 'people'):
        states.update('bodies', text)
    assert [text for _, text in log.lines][3:] == ['masks', 'people']
