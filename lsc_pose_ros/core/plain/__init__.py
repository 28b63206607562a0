"""The hot kernels once more, written as their equations read.

The fast ones are tested against them, and `lsc_pose bench` says how much faster they are.
"""
