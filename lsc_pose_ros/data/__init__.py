"""Recordings, importers, model files and synthetic people; imports core, never rclpy."""
