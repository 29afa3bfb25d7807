"""The segments of a mesh as separate meshes and files."""
