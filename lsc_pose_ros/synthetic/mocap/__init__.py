"""Motion capture files and their retargeting to any body."""
