"""The pixel formats of image messages, and their compressions."""
