"""The queue of jobs in Redis, and what else is kept there."""
