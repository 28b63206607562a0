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

"""The node with an estimator that takes long, for the tests of overload.

slow_node.py SECONDS --ros-args ...
"""

import sys
import time
from typing import Any

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.ros.node.main import main

SECONDS = float(sys.argv.pop(1))
estimate = Estimator.estimate_largest


def estimate_slowly(self: Estimator, *arguments: Any) -> tuple[Skeletons, int]:
    time.sleep(SECONDS)
    return estimate(self, *arguments)


Estimator.estimate_largest = estimate_slowly  # type: ignore[method-assign,assignment]

sys.exit(main())
