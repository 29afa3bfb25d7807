"""Real mesh files, read by Cleave and by other readers."""
