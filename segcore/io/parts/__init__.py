"""The segments of a mesh as meshes and files of their own."""
