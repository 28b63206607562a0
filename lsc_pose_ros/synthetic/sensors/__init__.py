"""Depth cameras and models of their noise."""
