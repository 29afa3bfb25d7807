"""The state of processes that tests have started, from /proc."""

import subprocess
from collections.abc import Callable
from pathlib import Path

StartWorker = Callable[..., "subprocess.Popen[bytes]"]  # takes a size class, a program, and settings as keywords


def children_of(pid: int) -> list[int]:
    """Return the process ids of the children of a process."""
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except FileNotFoundError:
        return []


def is_alive(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
