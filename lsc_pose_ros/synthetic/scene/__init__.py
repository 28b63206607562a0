"""Room, placement of the people, and rendering."""
