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

"""Bytes from strangers never crash a reader, lead it to allocate much, or get a long message.

`make fuzz MINUTES=10` tries far more.
"""

import pytest

pytest.importorskip('hypothesis', reason='hypothesis is not installed')

from fuzz_targets import targets
from fuzzing import fuzz

TARGETS = targets()


@pytest.mark.parametrize('name', TARGETS)
def test_good_bytes_are_read(name):
    for data in TARGETS[name].seeds:
        TARGETS[name].read(data)


@pytest.mark.parametrize('name', TARGETS)
def test_changed_bytes_are_read_or_refused(name):
    fuzz(TARGETS[name], 25)
