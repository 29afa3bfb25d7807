"""Cleave's own kernels beside those of libraries, on the same inputs."""
