"""The body: shape, skin, bones, clothes, and collisions of its limbs."""
