"""Where the compiled kernels are kept, also where the installation is read-only as it is in a container."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

_VARIABLE = "NUMBA_CACHE_DIR"


def prepare_kernel_cache(data_dir: Callable[[], Path]) -> None:
    """See to it that numba can write its cache, in this process and in those that it starts.

    To be called before a kernel is imported: numba refuses to import one whose cache it cannot write. Kernels that came
    with a read-only installation are copied, so that they are not compiled again.
    """
    shipped = os.environ.get(_VARIABLE)
    if os.access(shipped or Path(__file__).parents[2] / "segcore", os.W_OK):
        return
    kept = data_dir() / "kernels"
    os.environ[_VARIABLE] = str(_copied(Path(shipped), kept) if shipped and Path(shipped).is_dir() else kept)


def _copied(shipped: Path, kept: Path) -> Path:
    """A copy of a folder in another one, whole or not there, and made once."""
    copy = kept / _digest(shipped)
    if not copy.exists():
        kept.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=kept) as temporary:
            whole = Path(temporary) / "whole"
            shutil.copytree(shipped, whole)
            with suppress(OSError):  # another process was quicker
                whole.rename(copy)
    return copy


def _digest(folder: Path) -> str:
    """Another one for other kernels."""
    files = sorted((path, path.stat()) for path in folder.rglob("*") if path.is_file())
    given = [(str(path.relative_to(folder)), status.st_size, status.st_mtime_ns) for path, status in files]
    return hashlib.sha256(repr(given).encode()).hexdigest()[:16]
