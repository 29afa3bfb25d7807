"""Weighted graphs, trees of their cuts, and algorithms on them; independent of meshes."""
