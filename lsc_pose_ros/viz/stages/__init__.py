"""Figures of the stages of the method for one body."""
