"""PartData: the accessors, pictures and materials of a glTF file that holds one part of another one."""

import copy
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Document, Item, view_bytes
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.kept.entries import add_once

_BOUNDS = ("min", "max")
_PLACE = ("bufferView", "byteOffset", "sparse", *_BOUNDS)


@dataclass(slots=True, eq=False)
class PartData:
    """A new asset that takes over what it needs of a divided one, each entry once."""

    source: Document  # the divided document, whose primitives all have indices and no compression of their own
    accessors: Accessors
    asset: KeptAsset
    _taken: dict[tuple[str, int], int] = field(default_factory=dict)

    def primitive(self, entry: Item) -> Item:
        """Return a primitive with the vertices that its faces use."""
        corners = self.accessors.stored(entry["indices"])[:, 0]
        used, place = np.unique(corners, return_inverse=True)
        new: Item = {key: entry[key] for key in ("extras",) if key in entry}
        new["attributes"] = self._rows(entry["attributes"], used)
        new["indices"] = self.asset.add_indices(place.astype("<u2" if len(used) < 2**16 else "<u4"))
        if "targets" in entry:
            new["targets"] = [self._rows(target, used) for target in entry["targets"]]
        if "material" in entry:
            new["material"] = self.material(entry["material"])
        return new

    def accessor(self, index: int, *, is_attribute: bool = False) -> int:
        """Return an accessor with all numbers of one of the source."""
        if ("accessors", index) not in self._taken:
            self._taken["accessors", index] = self._accessor(index, self.accessors.stored(index), is_attribute)
        return self._taken["accessors", index]

    def material(self, index: int) -> int:
        if ("materials", index) not in self._taken:
            entry = copy.deepcopy(self.source.item("materials", index))
            for texture in _texture_references(entry):
                texture["index"] = self._texture(texture["index"])
            self._taken["materials", index] = self.asset.add("materials", entry)
        return self._taken["materials", index]

    def _texture(self, index: int) -> int:
        if ("textures", index) not in self._taken:
            entry = copy.deepcopy(self.source.item("textures", index))
            if "sampler" in entry:
                sampler = self.source.item("samplers", entry["sampler"])
                entry["sampler"] = add_once(self.asset.entries("samplers"), sampler)
            extensions = entry.get("extensions", {}).values()
            for holder in (entry, *extensions):
                if "source" in holder:
                    holder["source"] = self._picture(holder["source"])
            self._taken["textures", index] = self.asset.add("textures", entry)
        return self._taken["textures", index]

    def _picture(self, index: int) -> int:
        if ("images", index) not in self._taken:
            entry = dict(self.source.item("images", index))
            if "bufferView" in entry:
                entry["bufferView"] = self.asset.add_view(view_bytes(self.source, entry["bufferView"]))
            self._taken["images", index] = self.asset.add("images", entry)
        return self._taken["images", index]

    def _rows(self, attributes: Item, used: NDArray[Any]) -> Item:
        rows = {}
        for name, index in attributes.items():
            values = self.accessors.stored(index)
            if len(values) <= used[-1]:
                raise InvalidMesh(f"accessors[{index}] of the glTF file has fewer values than its mesh has vertices.")
            rows[name] = self._accessor(index, values[used], is_attribute=True)
        return rows

    def _accessor(self, index: int, values: NDArray[Any], is_attribute: bool) -> int:
        old = self.source.item("accessors", index)
        entry = {key: value for key, value in old.items() if key not in _PLACE}
        entry |= {"count": len(values)}
        values = values.astype(self.accessors.dtype(index), copy=False)
        entry["bufferView"] = self.asset.add_rows(values, is_attribute=is_attribute)
        if len(values) and any(key in old for key in _BOUNDS):
            entry |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self.asset.add("accessors", entry)


def new_asset(source: Document) -> KeptAsset:
    """Return an empty asset that is called as a document."""
    return KeptAsset({"asset": copy.deepcopy(source.root["asset"]), "bufferViews": [], "buffers": []}, [])


def _texture_references(entry: Any) -> Iterator[Item]:
    """The objects inside a material that refer to a texture by its number."""
    if isinstance(entry, dict):
        if type(entry.get("index")) is int:
            yield entry
        for key, value in entry.items():
            if key != "extras":
                yield from _texture_references(value)
