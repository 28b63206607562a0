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

"""A camera as users start it first: large images, best effort, Fast DDS as it comes.

default_camera.py RATE, in images a second, until it is stopped.
"""

import array
import sys
import time

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

rclpy.init()
node = Node('default_camera')
publisher = node.create_publisher(Image, 'depth/image', qos_profile_sensor_data)
image = Image(height=480, width=640, encoding='16UC1', step=1280)
image.data = array.array('B', bytes(640 * 480 * 2))
while rclpy.ok():
    image.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(image)
    time.sleep(1 / float(sys.argv[1]))
