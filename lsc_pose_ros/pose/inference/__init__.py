"""From votes to joints: densities, the pictorial structure, confidence (eq. 13 to 17)."""
