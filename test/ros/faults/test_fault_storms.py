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

"""Storms of parameter changes and of transitions, while frames come."""

import numpy as np
from fault_stream import FaultStream

from lsc_pose_ros.settings.table import NodeSettings

# For each parameter, values that an active node accepts, and values that it refuses.
VALUES: dict[str, tuple[list[object], list[object]]] = {
    'query_points': ([0, 10, 30], [9999, -1]),
    'maximum_bodies': ([1, 1000], [0]),
    'sync_slop': ([0.0, 1.0], [-1.0]),
    'smoothing': ([True, False], []),
    'smoothing_cutoff': ([0.01, 100.0], [0.0]),
    'smoothing_beta': ([0.0, 100.0], [-1.0]),
    'minimum_confidence': ([0.0, 1.0], [2.0]),
    'minimum_body_confidence': ([0.0, 1.0], [2.0]),
    'minimum_stature': ([0.0, 2.0], [3.0]),
    'marker_lifetime': ([0.0, 3600.0], [-1.0]),
    'hidden_joints': (['nan', 'low_confidence'], ['none']),
    'model': ([], ['/nowhere']),
    'nonsense': ([], [1, 'x']),
}


def test_storm_of_parameter_changes(stream: FaultStream) -> None:
    changes = [
        (name, value, refused)
        for name, kinds in VALUES.items()
        for refused, values in enumerate(kinds)
        for value in values
    ]
    random = np.random.default_rng(0)
    # Each change three times, in any order.
    for number, which in enumerate(random.permutation(np.repeat(np.arange(len(changes)), 3))):
        name, value, refused = changes[which]
        reason = stream.services.set(name, value)
        assert bool(reason) == bool(refused), (name, value, reason)
        if number % 5 == 0:
            stream.send(stream.good())
    defaults = NodeSettings()
    for name in VALUES:
        if hasattr(defaults, name) and name != 'model':
            assert not stream.services.set(name, getattr(defaults, name))
    assert 'ERROR' not in stream.program.output


# The numbers of lifecycle_msgs/Transition, and one that there is not.
NUMBERS = {'configure': 1, 'cleanup': 2, 'activate': 3, 'deactivate': 4, 'nonsense': 99}

NEXT_STATE = {
    ('unconfigured', 'configure'): 'inactive',
    ('inactive', 'cleanup'): 'unconfigured',
    ('inactive', 'activate'): 'active',
    ('active', 'deactivate'): 'inactive',
}


def test_storm_of_transitions(stream: FaultStream) -> None:
    random = np.random.default_rng(1)
    words = [*NUMBERS, 'activate']
    state = 'active'
    for _ in range(40):
        word = words[random.integers(len(words))]
        by_number = random.integers(2)
        succeeded = (
            stream.services.change_by_number(NUMBERS[word])
            if by_number
            else stream.services.change(word)
        )
        assert succeeded == ((state, word) in NEXT_STATE), (state, word, by_number)
        state = NEXT_STATE.get((state, word), state)
        assert stream.services.state == state
        stream.send(stream.good())
    for word in ('configure', 'activate'):
        stream.services.change(word)
    assert stream.services.state == 'active'
    stream.connect()


def test_requests_that_do_not_fit_the_state_are_refused(stream: FaultStream) -> None:
    assert stream.services.state == 'active'
    for number in (1, 3, 99, 255):
        assert not stream.services.change_by_number(number)
        stream.ask(stream.good())
    for word in ('configure', 'cleanup', 'activate', 'nonsense', ''):
        assert not stream.services.change(word)
    assert stream.services.state == 'active'
