"""A revision: the parts of a job after an edit of a person."""

from dataclasses import dataclass
from datetime import datetime

_LONGEST_WORDS = 300  # set by hand


@dataclass(frozen=True, slots=True, kw_only=True)
class Revision:
    """What is known about a revision besides its parts. Revision 0 is the automatic result and has no record."""

    number: int  # 1, 2, ...: the parent's and one more
    parent: int
    made_at: datetime  # UTC
    made_by: str | None  # the name of the API key of the request; None if there was none
    what: str  # the operations in words
    parts: int  # their number
    request: str | None = None  # identifies the request by its Idempotency-Key; None if it had none
    content: str | None = None  # a hash of what that request asked for


def words_of_revision(words: str) -> str:
    """Return what a revision has changed, shortened."""
    return words if len(words) <= _LONGEST_WORDS else words[: _LONGEST_WORDS - 1] + "…"
