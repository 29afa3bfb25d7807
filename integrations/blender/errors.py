"""The errors that people are shown."""


class CleaveError(Exception):
    """A sentence that says what is wrong and what to do."""


class CanceledError(CleaveError):
    """The user has ended the work."""
