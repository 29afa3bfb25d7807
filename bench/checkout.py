"""Other versions of this repository, checked out beside it."""

import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bench.errors import BenchmarkError

HERE = Path(__file__).parents[1]


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """Check a commit out to a folder, which is removed at the end.

    Raises
    ------
    BenchmarkError
        If git cannot do so.
    """
    with tempfile.TemporaryDirectory(prefix="base-") as name:
        folder = Path(name) / "base"
        added = _git("worktree", "add", "--detach", str(folder), commit)
        if added.returncode:
            raise BenchmarkError(f"git has no version {commit!r}: {added.stderr.strip()}")
        try:
            yield folder
        finally:
            _git("worktree", "remove", "--force", str(folder))


@contextmanager
def version(name: str) -> Iterator[Path]:
    """Return the folder of a version: the folder itself if the name is that of a checkout, or a commit checked out.

    Raises
    ------
    BenchmarkError
        If there is no such version.
    """
    if (Path(name) / "segcore").is_dir():
        yield Path(name).resolve()
        return
    with checked_out(name) as folder:
        yield folder


def _git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", "-C", str(HERE), *arguments], capture_output=True, text=True, check=False)
