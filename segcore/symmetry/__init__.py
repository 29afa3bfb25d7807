"""Symmetry of a surface: a reflection that maps it to itself, and clusters that the reflection maps to each other."""
