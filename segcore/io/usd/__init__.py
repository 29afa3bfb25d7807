"""The writers of USD."""
