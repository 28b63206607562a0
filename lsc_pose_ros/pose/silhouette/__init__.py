"""From the depth of one body to points on its silhouette (eq. 1, 2)."""
