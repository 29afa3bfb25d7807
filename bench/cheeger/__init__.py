"""Measurements of the solvers: the normalized Cheeger cuts (NCC) that they find, and their times."""
