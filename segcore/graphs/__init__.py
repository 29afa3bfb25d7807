"""Weighted graphs and trees, and the algorithms on them that know nothing of meshes."""
