"""The data types that all parts of the package use: camera, frame, joints, skeletons."""
