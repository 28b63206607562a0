"""Arrays to ROS messages and back; needs neither rclpy nor a bag library."""
