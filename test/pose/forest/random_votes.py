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

"""Random votes in leaves."""

import numpy as np

from lsc_pose_ros.pose.forest.forest import LeafVotes


def random_votes(rng: np.random.Generator, leaves: int, targets: int) -> LeafVotes:
    counts = rng.integers(0, 6, leaves)
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    total = int(start[-1])
    return LeafVotes(
        start,
        rng.integers(0, targets, total).astype(np.uint8),
        rng.normal(0, 0.2, (total, 3)).astype(np.float32),
        # Few different weights, so that many are equal at the limit.
        rng.choice([0.2, 0.5, 0.5, 0.9], total).astype(np.float32),
    )
