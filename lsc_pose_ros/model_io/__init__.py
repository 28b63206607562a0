"""Model files: the format, and checks of what is read."""
