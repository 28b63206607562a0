"""Compilation and caching of the numeric kernels, and fast elementary functions."""
