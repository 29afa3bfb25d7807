"""Edits of parts: their documents, the revisions that they make, and the processes that compute slow ones."""
