"""Lists of a glTF document whose entries are referred to by their numbers."""

from typing import TypeVar

Entry = TypeVar("Entry")


def add_once(entries: list[Entry], entry: Entry) -> int:
    """Return the number of an entry, which is appended if the list does not have it."""
    if entry not in entries:
        entries.append(entry)
    return entries.index(entry)
