"""Helpers of the tests of the list of parts."""
