"""The process that puts back lost jobs and deletes what is not kept."""
