"""A small graph that is cut in place of the mesh, over all components that touch."""
