"""Words and numbers of text files, read and written in bulk."""
