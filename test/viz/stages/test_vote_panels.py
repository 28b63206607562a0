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

"""The votes for one joint."""

import numpy as np

from lsc_pose_ros.viz.stages.shown_body import ShownBody
from lsc_pose_ros.viz.stages.vote_panels import positions_and_weights


def test_positions_and_weights_are_those_of_one_target(shown: ShownBody) -> None:
    assert shown.model is not None
    votes = shown.result.joint_votes
    parts = [positions_and_weights(votes, joint) for joint in range(len(votes.start) - 1)]
    np.testing.assert_array_equal(
        np.concatenate([positions for positions, _ in parts]), votes.position
    )
    np.testing.assert_array_equal(np.concatenate([part[1] for part in parts]), votes.weight)
