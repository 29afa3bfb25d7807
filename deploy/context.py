"""Which files of a folder a Dockerfile may copy, as its .dockerignore says."""

from fnmatch import fnmatch
from pathlib import Path

_ANYWHERE = "**/"


def is_sent(path: str, patterns: list[str]) -> bool:
    """Whether a file, by its path below the folder, is sent to the builder; the last pattern that matches decides."""
    sent = True
    for pattern in patterns:
        if _matches(path, pattern.removeprefix("!")):
            sent = pattern.startswith("!")
    return sent


def read_patterns(ignore_file: Path) -> list[str]:
    lines = [line.strip() for line in ignore_file.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def _matches(path: str, pattern: str) -> bool:
    """Whether a path or one of the folders that it is in matches."""
    parts = path.split("/")
    if pattern.startswith(_ANYWHERE):
        return any(fnmatch(part, pattern.removeprefix(_ANYWHERE)) for part in parts)
    depth = pattern.count("/") + 1
    return len(parts) >= depth and fnmatch("/".join(parts[:depth]), pattern)
