"""The accessors of a glTF asset as arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh
from segcore.io.gltf.compression.meshopt import MESHOPT, decode_view
from segcore.io.gltf.document import Document, Item, integer, member, view_bytes
from segcore.io.limits import ReadLimits

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_SMALL = 65536  # elements of an accessor without data that are allowed in a file of any size; set by hand


class Accessors:
    """Reads accessors; compressed buffer views are decoded once."""

    def __init__(self, document: Document, limits: ReadLimits) -> None:
        self._document = document
        self._limits = limits
        self._views: dict[int, memoryview] = {}  # decoded ones
        self._supplied: dict[int, NDArray[Any]] = {}

    def supply(self, index: int, values: NDArray[Any], where: str) -> None:
        """Set the (count, width) values of an accessor that were decoded from the member ``where`` of the document."""
        count = self.count(index)
        if len(values) != count:
            raise InvalidMesh(
                f"{where} of the glTF file holds {len(values)} values for accessors[{index}], "
                f"which should have {count}: it is damaged."
            )
        if index in self._supplied and not np.array_equal(self._supplied[index], values):
            raise InvalidMesh(f"accessors[{index}] of the glTF file has data at two places that contradict each other.")
        self._supplied[index] = values

    def count(self, index: int) -> int:
        """Return the number of elements of an accessor."""
        return integer(self._document.item("accessors", index), "count", f"accessors[{index}]")

    def dtype(self, index: int) -> np.dtype[Any]:
        """Return the type of the numbers of an accessor."""
        return _component(self._document.item("accessors", index), f"accessors[{index}]")

    def read(self, index: int, kind: str) -> NDArray[Any]:
        """Return the (count, width) numbers of an accessor, normalized ones as float64 in -1..1.

        Parameters
        ----------
        kind : ``SCALAR``, ``VEC2``, ``VEC3``, ``VEC4`` or ``MAT4``.

        Raises
        ------
        InvalidMesh
            If the accessor has another kind or reaches beyond its data; the message names it.
        """
        entry = self._document.item("accessors", index)
        if entry.get("type") != kind:
            raise InvalidMesh(f"accessors[{index}] of the glTF file must be of type {kind}.")
        values = self.stored(index)
        return _normalized(values) if entry.get("normalized") is True and values.dtype.kind in "iu" else values

    def stored(self, index: int) -> NDArray[Any]:
        """Return the (count, width) numbers of an accessor as they are stored, with sparse ones in their places.

        Raises
        ------
        InvalidMesh
            If the accessor is of an unknown kind or reaches beyond its data; the message names it.
        """
        entry, where = self._document.item("accessors", index), f"accessors[{index}]"
        kind = entry.get("type")
        if not isinstance(kind, str) or kind not in _WIDTHS:
            raise InvalidMesh(f"{where} of the glTF file must be of one of the types {', '.join(_WIDTHS)}.")
        dtype, count = _component(entry, where), self.count(index)
        if index in self._supplied:
            values = self._supplied[index]
            if values.shape[1:] != (_WIDTHS[kind],):
                raise InvalidMesh(f"{where} of the glTF file has compressed data of another type than {kind}.")
        elif "bufferView" in entry:
            values = self._view(entry, where, dtype, count, _WIDTHS[kind])
        elif count <= max(_SMALL, self._document.size):
            values = np.zeros((count, _WIDTHS[kind]), dtype)
        else:
            raise InvalidMesh(f"{where} of the glTF file has {count} elements without data: it is damaged.")
        if "sparse" in entry:
            values = self._with_sparse(values, member(entry, "sparse", where), f"{where}.sparse")
        return values

    def _view(self, item: Item, where: str, dtype: np.dtype[Any], count: int, width: int) -> NDArray[Any]:
        """(count, width) elements of the buffer view of ``item``, without a copy."""
        view = integer(item, "bufferView", where)
        entry, name = self._document.item("bufferViews", view), f"bufferViews[{view}]"
        data = self._view_bytes(view, entry, name)
        size = width * dtype.itemsize
        stride = integer(entry, "byteStride", name, size)
        offset = integer(item, "byteOffset", where, 0)
        if stride < size or offset + stride * max(count - 1, 0) + size > len(data):
            raise InvalidMesh(f"{where} of the glTF file reaches beyond the {len(data)} bytes of {name}.")
        return np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize))

    def _view_bytes(self, view: int, entry: Item, name: str) -> memoryview:
        extensions = entry.get("extensions")
        codec = next((key for key in MESHOPT if isinstance(extensions, dict) and key in extensions), None)
        if codec is None:
            return view_bytes(self._document, view)
        if view not in self._views:
            where = f"{name}.extensions.{codec}"
            self._views[view] = decode_view(
                self._document, member(entry["extensions"], codec, name), where, self._limits
            )
        return self._views[view]

    def _with_sparse(self, values: NDArray[Any], sparse: Item, where: str) -> NDArray[Any]:
        count = integer(sparse, "count", where)
        places = member(sparse, "indices", where)
        replaced = self._view(places, f"{where}.indices", _component(places, where), count, 1)[:, 0].astype(np.int64)
        if replaced.size and replaced.max() >= len(values):
            raise InvalidMesh(f"{where}.indices of the glTF file has an index beyond the {len(values)} elements.")
        result = values.copy()
        source = member(sparse, "values", where)
        result[replaced] = self._view(source, f"{where}.values", values.dtype, count, values.shape[1])
        return result


def _component(item: Item, where: str) -> np.dtype[Any]:
    code = integer(item, "componentType", where)
    if code not in _COMPONENTS:
        raise InvalidMesh(f"{where}.componentType of the glTF file is {code}, which is not a type of glTF.")
    return np.dtype(_COMPONENTS[code])


def _normalized(values: NDArray[Any]) -> NDArray[Any]:
    """Integers divided by the largest one of their type, at least -1 (glTF 2.0, section 3.11)."""
    return np.maximum(values / float(np.iinfo(values.dtype).max), -1.0)
