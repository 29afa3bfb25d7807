"""The build context: the files of a folder that .dockerignore lets a Dockerfile copy."""

from fnmatch import fnmatch
from pathlib import Path

_ANYWHERE = "**/"


def is_sent(path: str, patterns: list[str]) -> bool:
    """Whether a file is sent to the builder. The last pattern that matches decides.

    Parameters
    ----------
    path : of the file, relative to the folder.
    """
    sent = True
    for pattern in patterns:
        if _matches(path, pattern.removeprefix("!")):
            sent = pattern.startswith("!")
    return sent


def read_patterns(ignore_file: Path) -> list[str]:
    """Return the patterns of a .dockerignore file, without comments."""
    lines = [line.strip() for line in ignore_file.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def _matches(path: str, pattern: str) -> bool:
    """Whether a path or one of its parent folders matches a pattern."""
    parts = path.split("/")
    if pattern.startswith(_ANYWHERE):
        return any(fnmatch(part, pattern.removeprefix(_ANYWHERE)) for part in parts)
    depth = pattern.count("/") + 1
    return len(parts) >= depth and fnmatch("/".join(parts[:depth]), pattern)
