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


"""Stamps as nanoseconds."""

from types import SimpleNamespace

import pytest

from lsc_pose_ros.messages.stamps import nanoseconds, sec_nanosec


@pytest.mark.parametrize(
    ('sec', 'nanosec', 'expected'),
    [
        (5, 7, 5_000_000_007),
        (-1, 999_999_999, -1),
        (5, 10**9, 5_999_999_999),
        (2**31 - 1, 2**32 - 1, 2_147_483_647_999_999_999),
    ],
)
def test_nanoseconds_of_a_stamp_fit_the_fields_again(sec, nanosec, expected):
    stamp = nanoseconds(SimpleNamespace(sec=sec, nanosec=nanosec))
    assert stamp == expected
    assert sec_nanosec(stamp) == (sec, min(nanosec, 999_999_999))
