"""Edits: their operations as documents, and the process that computes one that waits in the queue."""
