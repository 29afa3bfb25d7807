"""The list of parts: its time, and whether copies are found."""
