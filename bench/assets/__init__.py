"""Authored assets: meshes with the parts that their authors made."""
