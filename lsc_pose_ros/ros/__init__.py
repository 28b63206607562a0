"""The live node, its messages and parameters: the only place that imports rclpy."""
