"""What the node says of itself: diagnostics, warnings, the log."""
