"""Unique names of segments in files and on the page: the given names, else ``segment`` and the label."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import TypeAlias

SegmentNames: TypeAlias = Mapping[int, str]  # by label; labels that do not exist are ignored

DEFAULT_SEGMENT_NAME = "segment"  # followed by the label
_LONGEST = 60  # characters; file names are limited to 255 bytes, and UTF-8 takes up to four for a character


def segment_names(names: SegmentNames | None, count: int, separator: str = " ") -> list[str]:
    """Return the names of the labels 0..count - 1: the given name, else ``segment`` and the label.

    ``separator`` replaces white space and unprintable characters. The label is appended to a name that an earlier label
    has, because some programs merge parts with equal names.
    """
    given = names or {}
    taken: set[str] = set()
    result = []
    for label in range(count):
        words = one_line(given.get(label, "")).split() or [DEFAULT_SEGMENT_NAME, str(label)]
        name = separator.join(words)[:_LONGEST]
        while name.casefold() in taken:
            name += f"{separator}{label}"
        taken.add(name.casefold())
        result.append(name)
    return result


def group_names(names: SegmentNames | None, count: int) -> list[str]:
    """The same for groups of OBJ, without white space, ``#`` (a comment) and ``\\`` (a continued line)."""
    plain = {label: re.sub(r"[#\\]+", " ", name) for label, name in (names or {}).items()}
    return segment_names(plain, count, "_")


def file_stems(names: SegmentNames | None, count: int) -> list[str]:
    """The same for file names: safe on every system, and their alphabetical order is that of the labels."""
    digits = len(str(count - 1))
    words = {label: re.findall(r"\w+", name) for label, name in (names or {}).items()}
    return [
        "_".join([f"{DEFAULT_SEGMENT_NAME}_{label:0{digits}}", *words.get(label, [])])[:_LONGEST]
        for label in range(count)
    ]


def identifiers(names: Sequence[str], taken: Collection[str] = ()) -> list[str]:
    """Names as identifiers of letters, digits and underscores, for files in which nothing else is valid.

    Other characters become an underscore, and numbers are appended to names that are taken, ignoring case.
    """
    used = {name.casefold() for name in taken}
    result = []
    for number, name in enumerate(names):
        word = "_".join(re.findall(r"[A-Za-z0-9_]+", name)) or f"{DEFAULT_SEGMENT_NAME}_{number}"
        plain = word = f"_{word}" if word[0].isdigit() else word
        repeat = 1
        while word.casefold() in used:
            repeat += 1
            word = f"{plain}_{repeat}"
        used.add(word.casefold())
        result.append(word)
    return result


def comment(text: str) -> str:
    """A text for a comment of OBJ, in which a backslash at the end would continue the line."""
    return one_line(text).replace("\\", "/")


def one_line(text: str) -> str:
    """A text with a space for each unprintable character."""
    return "".join(character if character.isprintable() else " " for character in text)
