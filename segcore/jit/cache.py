"""The cache of compiled kernels, chosen when segcore is imported.

numba keeps the kernels beside their modules or in the cache folder of the user, and refuses to import them if it can
write neither, as in an installation that belongs to root, without a home. The kernels are then kept in the temporary
folder, and if that cannot be written either, they are compiled again in every process. numba is not imported if the
first place that it tries can be written, as in most installations.
"""

import logging
import os
import stat
import sys
import tempfile
from pathlib import Path

log = logging.getLogger("segcore")

_VARIABLE = "NUMBA_CACHE_DIR"


def _choose() -> None:
    if ("numba" not in sys.modules and _can_be_written(_first_place())) or _has_place():
        return
    try:
        folder = str(_private_folder())
    except OSError as error:
        _compile_always(str(error))
        return
    _use(folder)
    if not _has_place():
        _compile_always(f"{folder} cannot be written")


def _first_place() -> Path:
    """Return the folder in which numba tries to keep the kernels before any other."""
    chosen = os.environ.get(_VARIABLE)
    return Path(chosen) if chosen else Path(__file__).with_name("__pycache__")


def _can_be_written(folder: Path) -> bool:
    """Whether a folder can be written, or made beside others."""
    existing = folder if folder.exists() else folder.parent
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)


def _has_place() -> bool:
    """Whether numba finds a place for the kernels of this package."""
    from numba.core.caching import CompileResultCacheImpl

    try:
        CompileResultCacheImpl(_choose)
    except RuntimeError:
        return False
    return True


def _use(folder: str) -> None:
    import numba

    numba.config.CACHE_DIR = os.environ[_VARIABLE] = folder  # also of child processes


def _private_folder() -> Path:
    """Return a folder in the temporary folder that this user alone can write; OSError if there is none."""
    folder = Path(tempfile.gettempdir()) / f"cleave-kernels-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o022:
        raise OSError(f"{folder} belongs to another user")
    return folder


def _compile_always(reason: str) -> None:
    from numba.core.registry import CPUDispatcher

    log.warning("kernels are compiled in every process, because %s: set NUMBA_CACHE_DIR to a writable folder", reason)
    CPUDispatcher.enable_caching = lambda _: None


_choose()
