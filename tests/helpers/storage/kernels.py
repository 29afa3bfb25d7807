"""The cache of kernels for tests: an empty one, and a copy of the one of this run."""

import os
import shutil
import sys
from pathlib import Path

from numba.core.caching import UserProvidedCacheLocator

import segcore
from segcore.array_kernels import dot
from segcore.kernels.place import KernelPlace

PACKAGE = Path(segcore.__file__).parent


def cache_folder(cache: Path, folder: Path = PACKAGE) -> Path:
    """Return where numba keeps the kernels of the modules of a folder if NUMBA_CACHE_DIR is ``cache``."""
    return cache / UserProvidedCacheLocator.get_suitable_cache_subpath(str(folder / "module.py"))


def copy_kernels(cache: Path) -> KernelPlace:
    """Copy the compiled kernels of this run to another cache, without the note that they are complete."""
    own = os.environ.get("NUMBA_CACHE_DIR")
    for folder in {path.parent for path in PACKAGE.rglob("*.py")}:
        source = cache_folder(Path(own), folder) if own else folder / "__pycache__"
        target = cache_folder(cache, folder)
        target.mkdir(parents=True)
        for file in source.glob("*.nb[ic]") if source.is_dir() else ():
            shutil.copy2(file, target)
    assert dot.stats.cache_path
    return KernelPlace(cache_folder(cache))


def python_command(script: str) -> list[str]:
    return [sys.executable, "-c", script]


def environment_with(cache: Path) -> dict[str, str]:
    return os.environ | {"NUMBA_CACHE_DIR": str(cache)}
