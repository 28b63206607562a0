"""The paper's method on plain arrays: numpy and numba only; no ROS, no file, no printing."""
