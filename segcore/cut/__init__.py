"""Recursive cuts of the coarse graph: the next segment, its cut, and the number of segments."""
