"""The coarse graph is cut again and again: which segment is next, where it is cut, and when to stop."""
