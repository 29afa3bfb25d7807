"""The one error of the benchmarks."""


class BenchmarkError(Exception):
    """A benchmark cannot run as asked; the message is one sentence that says what to do."""
