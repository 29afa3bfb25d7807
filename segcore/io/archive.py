"""ZIP archives of which equal contents are equal bytes."""

import zipfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

_DATE = (1980, 1, 1, 0, 0, 0)
FAST = 1  # the level of deflate that a writer does not wait for


def member(name: str, compressed: bool = False) -> zipfile.ZipInfo:
    """A member that is the same on every system and at any time."""
    info = zipfile.ZipInfo(name, _DATE)
    info.create_system = 3
    info.external_attr = 0o644 << 16
    info.compress_type = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    return info


def write_array(archive: zipfile.ZipFile, name: str, array: NDArray[Any], dtype: str) -> None:
    """Add ``name``.npy without compression."""
    with archive.open(member(f"{name}.npy"), "w", force_zip64=True) as target:
        np.lib.format.write_array(target, np.ascontiguousarray(array, dtype=dtype), version=(1, 0), allow_pickle=False)
