"""The members of a ``.cleave`` file: JSON values, and arrays in NumPy's format 1.0 without objects."""

import json
import math
import re
import zipfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh

_NPY_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00.."
    rb"\{'descr': '(?P<dtype>...)', 'fortran_order': False, 'shape': \((?P<shape>\d{1,12},(?: \d{1,12})?)\), \} *\n",
    re.DOTALL,
)


def read_json(archive: zipfile.ZipFile, name: str, most: int | None = None) -> Any:
    """Return the value of a member, of which at most ``most`` bytes are read.

    Raises
    ------
    InvalidMesh
        If there is no such member, or it is no JSON.
    """
    try:
        return json.loads(_read_member(archive, name)[:most])
    except (ValueError, RecursionError) as error:
        raise InvalidMesh(f"Member {name!r} of the .cleave file is damaged: make the file again.") from error


def read_array(archive: zipfile.ZipFile, name: str, dtype: str) -> NDArray[Any]:
    """Return the array of the member ``name``.npy.

    Raises
    ------
    InvalidMesh
        If there is no such member, or it is no array of this type.
    """
    data = _read_member(archive, f"{name}.npy")
    header = _NPY_HEADER.match(data)
    if header is None or header["dtype"] != dtype.encode():
        raise InvalidMesh(f"Array {name!r} of the .cleave file has the wrong type or shape: make the file again.")
    shape = tuple(int(extent) for extent in header["shape"].split(b",") if extent)
    if len(data) - header.end() != np.dtype(dtype).itemsize * math.prod(shape):
        raise InvalidMesh(f"Array {name!r} of the .cleave file has the wrong size: make the file again.")
    return np.frombuffer(data, dtype, offset=header.end()).reshape(shape).copy()


def _read_member(archive: zipfile.ZipFile, name: str) -> bytes:
    try:
        return archive.read(name)
    except KeyError as error:
        raise InvalidMesh(f"This is not a .cleave file: it has no member {name!r}.") from error
