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

"""The converters from millimetres to metres and from masks to labels."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.conversion import labels_from_mask, metres_from_millimetres
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError


@pytest.mark.parametrize('kind', ['u1', 'u2', '>u2', 'u4', 'i2', 'i4', 'i8', 'f4', 'f8'])
def test_millimetres_become_metres(kind):
    metres = metres_from_millimetres(np.array([[0, 1, 120]], kind))
    np.testing.assert_allclose(metres, [[0, 0.001, 0.12]], rtol=1e-6)
    assert metres.dtype == np.float32


def test_invalid_millimetres_become_zero():
    floats = metres_from_millimetres(np.array([[np.nan, np.inf, -np.inf, -5.0, 2000.0]]))
    np.testing.assert_array_equal(floats, np.array([[0, 0, 0, 0, 2]], np.float32))
    integers = metres_from_millimetres(np.array([[-5, 2000]], np.int16))
    np.testing.assert_array_equal(integers, np.array([[0, 2]], np.float32))


@pytest.mark.parametrize('kind', ['?', 'u1', 'u2', '>u2', 'u4', 'i1', 'i4', 'i8'])
def test_background_of_a_mask_becomes_no_body(kind):
    labels = labels_from_mask(np.array([[0, 1], [1, 0]], kind))
    np.testing.assert_array_equal(labels, [[NO_BODY, 1], [1, NO_BODY]])
    assert labels.dtype == np.int32


def test_background_can_have_any_value():
    azure = labels_from_mask(np.array([[255, 0, 1]], np.uint8), background=255)
    np.testing.assert_array_equal(azure, [[NO_BODY, 0, 1]])
    negative = labels_from_mask(np.array([[-1, 4]], np.int32), background=-1)
    np.testing.assert_array_equal(negative, [[NO_BODY, 4]])


@pytest.mark.parametrize('value', [-1, 65536])
def test_body_number_must_fit_the_message(value):
    with pytest.raises(InputError, match=f'body number {value}.*mask_background'):
        labels_from_mask(np.array([[0, value]], np.int32))


def test_large_unsigned_number_does_not_become_another_body():
    with pytest.raises(InputError, match='body number 4294967296'):
        labels_from_mask(np.array([[0, 2**32]], np.uint64))


@pytest.mark.parametrize(
    ('mask', 'what'),
    [
        (np.zeros((4, 5)), 'float64'),
        (np.zeros((4, 5, 3), np.uint8), r'\(4, 5, 3\)'),
        ([[0, 1]], 'list'),
    ],
)
def test_mask_of_another_kind_is_refused(mask, what):
    with pytest.raises(InputError, match=what):
        labels_from_mask(mask)


@pytest.mark.parametrize(
    ('image', 'what'),
    [(np.zeros((4, 5), bool), 'bool'), (np.zeros((4, 5, 1)), r'\(4, 5, 1\)'), ([[1]], 'list')],
)
def test_millimetres_of_another_kind_are_refused(image, what):
    with pytest.raises(InputError, match=what):
        metres_from_millimetres(image)
