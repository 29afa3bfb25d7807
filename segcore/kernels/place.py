"""Where the compiled kernels are: which groups are complete there, and who compiles the others."""

import fcntl
import hashlib
import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numba

from segcore.array_kernels import dot
from segcore.kernels.manifest import PATH

_PACKAGE = Path(__file__).parents[1]
_POLL_S = 0.1


@dataclass(frozen=True, slots=True)
class CompilationProgress:
    done: int
    count: int
    is_own: bool = True  # False if another process compiles

    def __str__(self) -> str:
        return f"compiling, once: {self.done} of {self.count}"


class KernelPlace:
    """The folder of numba's cache, with a lock for the process that compiles and a file of what it has done.

    The lock ends with its process, and the file is replaced as a whole, so that a process may be killed at any time.
    """

    def __init__(self, folder: Path) -> None:
        self._state = folder / "cleave-kernels.json"
        self._lock = folder / "cleave-kernels.lock"
        self._version = _version()

    def groups(self) -> frozenset[str]:
        """Return the groups whose kernels are all compiled, for this processor and these sources."""
        return frozenset(self._read().get("groups", ()))

    def progress(self) -> CompilationProgress | None:
        """Return how far the process is that compiles; None if none has begun."""
        document = self._read()
        return CompilationProgress(document["done"], document["count"]) if document else None

    def write(self, groups: frozenset[str], progress: CompilationProgress) -> None:
        document = {"version": self._version, "groups": sorted(groups), "done": progress.done, "count": progress.count}
        temporary = self._state.with_suffix(f".{os.getpid()}")
        temporary.write_text(json.dumps(document))
        temporary.replace(self._state)

    @contextmanager
    def locked(self, is_done: Callable[[], bool]) -> Iterator[bool]:
        """Wait until this process alone may compile, which is yielded as True, or until ``is_done``."""
        with self._lock.open("ab") as file:
            while not is_done():
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    time.sleep(_POLL_S)
                    continue
                yield not is_done()
                return
            yield False

    def _read(self) -> dict[str, Any]:
        try:
            document: dict[str, Any] = json.loads(self._state.read_text())
        except (OSError, ValueError):
            return {}
        return document if document.get("version") == self._version else {}


def kernel_place() -> KernelPlace | None:
    """Return the place of the compiled kernels; None if every process compiles its own."""
    folder = dot.stats.cache_path
    if folder is None:
        return None
    Path(folder).mkdir(parents=True, exist_ok=True)
    return KernelPlace(Path(folder))


def _version() -> str:
    """Return a digest of all that the compiled kernels depend on."""
    sources = sorted((str(path), path.stat()) for path in [PATH, *_PACKAGE.rglob("*.py")])
    files = [(path, status.st_size, status.st_mtime_ns) for path, status in sources]
    target = dot.targetctx.codegen().magic_tuple()
    text = repr((numba.__version__, platform.python_version(), target, files))
    return hashlib.sha256(text.encode()).hexdigest()
