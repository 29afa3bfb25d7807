"""Jobs: what one is, where its files live, the queue that hands it out, the process that runs it.

The store is the truth and the queue is disposable: a job is accepted when its record is durable in the store and
finished when its manifest is, and everything in Redis can be made again from the two.
"""
