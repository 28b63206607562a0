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

"""An evaluation for the tests of reports and plots."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.evaluation.evaluate import Evaluation


@pytest.fixture(scope='module')
def evaluation() -> Evaluation:
    rng = np.random.default_rng(5)
    errors = rng.gamma(2, 0.03, (40, len(DEFAULT_JOINTS))).astype(np.float32)
    errors[0, 3] = np.inf
    errors[:9, 5] = np.nan
    return Evaluation(
        numbers_of(DEFAULT_JOINTS),
        errors,
        np.arange(40),
        np.ones(40, np.uint16),
        np.full(40, 0.01),
        rng.random(errors.shape, np.float32),
        np.full((*errors.shape, 3), np.nan, np.float32),
        np.full(errors.shape, UNKNOWN, np.uint8),
    )
