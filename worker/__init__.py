"""Jobs: their records and files, the queue, the worker process that runs them, the janitor and the webhooks.

The store is the only state that counts: a job is accepted when its record is durable in the store, and finished when
its manifest is. Everything in Redis can be restored from these two.
"""
