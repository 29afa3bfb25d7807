"""Mesh files for the tests: small, unusual, damaged and hostile ones, and plain readers as oracles."""
