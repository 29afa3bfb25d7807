"""Decoders for compressed glTF: meshopt and Draco."""
