"""Robots, in the API and on the command line."""
