"""Synthetic people: bodies of simple solids, their motion, rendering and sensor noise."""
