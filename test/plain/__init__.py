"""The hot kernels in plain form, as their equations read: a reference for tests and speed."""
