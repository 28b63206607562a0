"""Pictures and reports, drawn from arrays."""
