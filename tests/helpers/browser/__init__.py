"""A visitor of the viewer page, and mesh files for it."""
