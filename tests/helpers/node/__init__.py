"""Programs of Node that read files for the tests, each in a folder with its lock file."""
