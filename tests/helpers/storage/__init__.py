"""Storage that fails or counts, for the tests of the store."""
