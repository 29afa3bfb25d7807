"""Mesh files for the tests: small, odd, damaged and hostile ones, and plain readers to compare with."""
