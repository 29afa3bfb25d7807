"""The queue of jobs in Redis, and the counters, locks, quotas and worker registrations there."""
