"""Measurements of the readers and writers of mesh files."""
