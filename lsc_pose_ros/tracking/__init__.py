"""Body numbers and joints over time."""
