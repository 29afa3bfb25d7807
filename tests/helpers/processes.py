"""The state of processes that tests have started, from /proc."""

import subprocess
from collections.abc import Callable
from pathlib import Path

from worker.process.spare import WAITING_NAME, WORKING_NAME

StartWorker = Callable[..., "subprocess.Popen[bytes]"]  # takes a size class, a program, and settings as keywords


def children_of(pid: int) -> list[int]:
    """Return the process ids of the children of a process."""
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except FileNotFoundError:
        return []


def horses_of(pid: int) -> list[int]:
    """Return the process ids of the children of a worker that run a job."""
    return _children_named(pid, WORKING_NAME)


def spares_of(pid: int) -> list[int]:
    """Return the process ids of the children of a worker that wait for a job."""
    return _children_named(pid, WAITING_NAME)


def _children_named(pid: int, name: str) -> list[int]:
    return [child for child in children_of(pid) if _name_of(child) == name]


def _name_of(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except (FileNotFoundError, ProcessLookupError):
        return ""


def is_alive(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
