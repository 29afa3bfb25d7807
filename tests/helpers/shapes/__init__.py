"""Meshes with known parts: symmetric creatures, and surfaces of patches that do not share vertices."""
