"""Estimation over a sequence of frames: bodies, joints, tracks; and the warm-up of its kernels."""
