"""Coarsening: the clusters that are cut in place of the mesh, and the links between components that touch."""
