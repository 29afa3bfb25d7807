"""Helpers of the tests of robots."""
