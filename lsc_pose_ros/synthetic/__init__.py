"""Synthetic people before a depth camera, with exact masks and joints."""
