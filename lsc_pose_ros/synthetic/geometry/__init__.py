"""Rotations, vectorised and as compiled kernels."""
