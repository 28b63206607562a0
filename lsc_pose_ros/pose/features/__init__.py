"""Descriptors of silhouette points (eq. 3, 4) and the features they are compared with."""
