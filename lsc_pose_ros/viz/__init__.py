"""Figures and reports, drawn from arrays."""
