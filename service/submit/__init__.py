"""Submissions: a request becomes meshes in the store and jobs in the queue."""
