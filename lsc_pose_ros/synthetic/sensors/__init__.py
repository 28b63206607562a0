"""Depth cameras and their noise."""
