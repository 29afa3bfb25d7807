"""The same shapes in other meshes, and the agreement of their segmentations."""
