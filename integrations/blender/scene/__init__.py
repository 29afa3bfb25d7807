"""Meshes of Blender: what is read of them, and what is written."""
