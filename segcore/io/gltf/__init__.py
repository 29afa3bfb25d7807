"""glTF 2.0 files, as JSON and as GLB."""
