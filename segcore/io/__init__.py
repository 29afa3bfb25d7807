"""Meshes in, segmentations out: the only code that knows file formats."""
