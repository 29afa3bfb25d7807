"""The compressions of glTF: meshopt and Draco."""
