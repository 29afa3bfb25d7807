"""The process that enqueues lost jobs again and deletes jobs that have expired."""
