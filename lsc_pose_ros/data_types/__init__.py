"""What every part of the package speaks of: camera, frame, joints, skeletons."""
