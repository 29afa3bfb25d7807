"""Numbers and words in text files, read and written in bulk."""
