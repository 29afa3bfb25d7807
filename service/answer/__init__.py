"""Results of jobs in the format, at the level and in the byte range that a client requests."""
