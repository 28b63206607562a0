"""What the node subscribes to and publishes."""
