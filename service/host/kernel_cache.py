"""The folder of compiled kernels: a writable one, even if the installation is read-only, as in a container."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from service.host.folders import can_be_made

_VARIABLE = "NUMBA_CACHE_DIR"


def prepare_kernel_cache(data_dir: Callable[[], Path]) -> None:
    """Give numba a writable cache, in this process and in its child processes.

    Call it before a kernel is imported: numba refuses to import one if it cannot write its cache. Kernels that are part
    of a read-only installation are copied into the data folder, so that they are not compiled again.
    """
    shipped = os.environ.get(_VARIABLE)
    if os.access(shipped or Path(__file__).parents[2] / "segcore", os.W_OK):
        return
    caches = data_dir() / "kernels"
    if not can_be_made(caches):
        return  # segcore finds another place
    os.environ[_VARIABLE] = str(_copy(Path(shipped), caches) if shipped and Path(shipped).is_dir() else caches)


def compiled_kernels() -> tuple[int, Path]:
    """Return the number of kernels that are compiled, and their folder."""
    chosen = os.environ.get(_VARIABLE)
    folder = Path(chosen) if chosen else Path(__file__).parents[2] / "segcore"
    return sum(1 for _ in folder.rglob("*.nbi")), folder


def _copy(shipped: Path, caches: Path) -> Path:
    """Copy a folder once, completely or not at all, and return the copy."""
    copy = caches / _digest(shipped)
    if not copy.exists():
        caches.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=caches) as temporary:
            complete = Path(temporary) / "complete"
            shutil.copytree(shipped, complete)
            with suppress(OSError):  # another process was faster
                complete.rename(copy)
    return copy


def _digest(folder: Path) -> str:
    """Return a digest of the names, sizes and times of all files: other kernels get another copy."""
    files = sorted((path, path.stat()) for path in folder.rglob("*") if path.is_file())
    entries = [(str(path.relative_to(folder)), status.st_size, status.st_mtime_ns) for path, status in files]
    return hashlib.sha256(repr(entries).encode()).hexdigest()[:16]
