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

"""The fixtures of the live tests, where ROS 2 is; without it those tests skip themselves."""

import importlib.util

if importlib.util.find_spec('rclpy') is not None:
    from live_ros import (  # noqa: F401
        active_node,
        camera,
        estimates,
        probe,
        ros_environment,
        services,
        shared_node,
        spawn_node,
        start_node,
        start_program,
    )
    from message_package import hri_packages  # noqa: F401
