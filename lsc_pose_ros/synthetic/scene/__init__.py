"""Placement of people and camera, the room, and rendering."""
