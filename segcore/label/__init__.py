"""Labels of the faces: the tree of cuts is carried over to the mesh, and its boundaries are refined."""
