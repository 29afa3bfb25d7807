"""Names of segments in files: those that were given, else their numbers; never two alike."""

import re
from collections.abc import Mapping
from typing import TypeAlias

SegmentNames: TypeAlias = Mapping[int, str]  # by label; labels that a file does not have are passed over

_LONGEST = 60  # characters, so that names of files stay below 255 bytes


def segment_names(names: SegmentNames | None, count: int, separator: str = " ") -> list[str]:
    """What the labels 0..count - 1 are called: the name that was given, or ``segment`` and the label.

    White space and what cannot be printed becomes ``separator``. A name that an earlier label has already gets its
    label behind it, as programs put together what is called the same.
    """
    given = names or {}
    taken: set[str] = set()
    result = []
    for label in range(count):
        words = one_line(given.get(label, "")).split() or ["segment", str(label)]
        name = separator.join(words)[:_LONGEST]
        while name.casefold() in taken:
            name += f"{separator}{label}"
        taken.add(name.casefold())
        result.append(name)
    return result


def group_names(names: SegmentNames | None, count: int) -> list[str]:
    """The same as groups of OBJ: white space parts names there, ``#`` begins a comment, a backslash goes on a line."""
    plain = {label: re.sub(r"[#\\]+", " ", name) for label, name in (names or {}).items()}
    return segment_names(plain, count, "_")


def file_stems(names: SegmentNames | None, count: int) -> list[str]:
    """The same as names of files that are safe on every system and stand in the order of the labels."""
    digits = len(str(count - 1))
    words = {label: re.findall(r"\w+", name) for label, name in (names or {}).items()}
    return ["_".join([f"segment_{label:0{digits}}", *words.get(label, [])])[:_LONGEST] for label in range(count)]


def comment(text: str) -> str:
    """A text that can stand in a comment of OBJ: there too, a backslash at the end of a line goes on."""
    return one_line(text).replace("\\", "/")


def one_line(text: str) -> str:
    """A text with spaces for everything that cannot be printed."""
    return "".join(character if character.isprintable() else " " for character in text)
