"""A camera as users start it first: large images, best effort, Fast DDS as it comes."""

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
end = time.monotonic() + float(sys.argv[1])
while time.monotonic() < end:
    image.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(image)
    time.sleep(0.03)
rclpy.try_shutdown()
