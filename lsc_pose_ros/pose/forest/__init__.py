"""The regression forest, the votes of its leaves, and the body yaw it is told."""
