"""What several tests use: meshes, files, servers, processes."""
