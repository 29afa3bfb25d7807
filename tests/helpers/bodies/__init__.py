"""Data sets for the tests of the benchmark, with values that are known by hand."""
