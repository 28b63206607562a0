"""How the numeric kernels are compiled and cached, and fast elementary functions."""
