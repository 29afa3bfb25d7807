"""Helpers of the tests of files for printing."""
