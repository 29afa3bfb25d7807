"""Measurements and pictures of the viewer in a browser."""
