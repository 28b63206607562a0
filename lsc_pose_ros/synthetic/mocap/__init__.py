"""Motion capture files, brought onto any body."""
