"""Synthetic people in front of a depth camera, with exact masks and joint positions."""
