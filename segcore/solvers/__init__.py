"""The solvers: each finds a small normalized Cheeger cut of a connected graph."""
