"""The worker process and the child process that runs one job."""
