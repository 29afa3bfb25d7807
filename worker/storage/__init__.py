"""What :class:`worker.store.JobStore` is made of: the seam to a folder or a bucket, and the kinds of objects in it."""
