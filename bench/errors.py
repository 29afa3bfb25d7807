"""The one exception of the benchmarks."""


class BenchmarkError(Exception):
    """A benchmark cannot run with these arguments or data; the message is one sentence with the remedy."""
