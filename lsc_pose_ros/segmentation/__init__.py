"""Bodies in a depth image that has no mask."""
