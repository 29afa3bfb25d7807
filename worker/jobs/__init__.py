"""What a job is, where it is stored and how it is queued."""
