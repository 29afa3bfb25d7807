"""The tree of cuts is carried over to the faces of the mesh, and the boundaries are drawn anew."""
