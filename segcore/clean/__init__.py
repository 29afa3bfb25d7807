"""Cleaning: a mesh becomes a welded and consistently oriented surface with its dual edges."""
