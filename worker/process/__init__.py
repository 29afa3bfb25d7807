"""The worker process, and the work-horse: its child process that runs one job."""
