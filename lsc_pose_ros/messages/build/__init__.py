"""Builds ROS messages from arrays, with the message classes of any ROS library."""
