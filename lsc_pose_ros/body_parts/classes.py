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


"""The classes of what a pixel shows: the part of a person, or no person."""

from lsc_pose_ros.data_types.joints import JOINT_NAMES

NOT_A_PERSON = 0
"""The class of everything that is not a person; class 1 + j is the part at joint number j."""

CLASSES = 1 + len(JOINT_NAMES)
"""The number of classes."""
