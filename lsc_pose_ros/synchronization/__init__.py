"""Depth image, mask and camera info of one moment, matched by their stamps."""
