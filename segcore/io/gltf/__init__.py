"""glTF 2.0 files, JSON and GLB."""
