"""What all figures share: canvas, colours, depth image, dots, skeletons, legend."""
