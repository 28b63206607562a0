"""The hot kernels once more, written as their equations read."""
