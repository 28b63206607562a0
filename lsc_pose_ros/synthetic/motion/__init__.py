"""Procedural poses and motion within the limits of the joints."""
