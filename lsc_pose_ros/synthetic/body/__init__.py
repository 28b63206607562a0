"""Body model: shape, skin, bones, clothes and self-collision."""
