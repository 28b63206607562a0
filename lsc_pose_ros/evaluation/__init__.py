"""Measures how accurate and how fast a model is."""
