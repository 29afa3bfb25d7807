"""Gives accessors and buffer views that nothing uses any more to new ones, so that the numbers of others stay."""

from collections.abc import Iterator
from typing import NamedTuple

from segcore.io.gltf.compression.draco import DRACO
from segcore.io.gltf.document import Document, Item, has_unknown_extensions
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.scene import INSTANCING


class _Reference(NamedTuple):
    """A member of a document that is the number of an accessor or a buffer view."""

    holder: Item
    key: str

    @property
    def value(self) -> object:
        return self.holder.get(self.key)


def reuse_slots(asset: KeptAsset, document: Document) -> None:
    """Move new accessors and views to the places of those that the document used and the changed one does not.

    A document with an unknown extension is not changed, because that may refer to any accessor or buffer view.
    """
    if has_unknown_extensions(document.root):
        return
    _reuse(asset.entries("accessors"), _accessor_references(document.root), _accessor_references(asset.root))
    _reuse(asset.entries("bufferViews"), _view_references(document.root), _view_references(asset.root))


def _reuse(entries: list[Item], before: list[_Reference], now: list[_Reference]) -> None:
    used = {reference.value for reference in now}
    unused = sorted(number for reference in before if type(number := reference.value) is int and number not in used)
    place: dict[object, int] = {}
    for free in dict.fromkeys(unused):
        place[len(entries) - 1] = free
        entries[free] = entries.pop()
    for reference in now:
        if reference.value in place:
            reference.holder[reference.key] = place[reference.value]


def _accessor_references(root: Item) -> list[_Reference]:
    holders = [
        (holder, key)
        for mesh in root.get("meshes", [])
        for primitive in mesh["primitives"]
        for holder, keys in _of_primitive(primitive)
        for key in keys
    ]
    copies = [node["extensions"][INSTANCING] for node in root.get("nodes", []) if INSTANCING in _extensions(node)]
    holders += [(entry["attributes"], key) for entry in copies for key in entry["attributes"]]
    holders += [(skin, "inverseBindMatrices") for skin in root.get("skins", [])]
    samplers = [sampler for animation in root.get("animations", []) for sampler in animation.get("samplers", [])]
    holders += [(sampler, key) for sampler in samplers for key in ("input", "output")]
    return [_Reference(holder, key) for holder, key in holders]


def _of_primitive(primitive: Item) -> Iterator[tuple[Item, list[str]]]:
    yield primitive, ["indices"]
    yield primitive["attributes"], list(primitive["attributes"])
    for target in primitive.get("targets", []):
        yield target, list(target)


def _view_references(root: Item) -> list[_Reference]:
    accessors = root.get("accessors", [])
    sparse = [accessor["sparse"] for accessor in accessors if "sparse" in accessor]
    primitives = [primitive for mesh in root.get("meshes", []) for primitive in mesh["primitives"]]
    holders = [
        *accessors,
        *(part[key] for part in sparse for key in ("indices", "values")),
        *root.get("images", []),
        *(primitive["extensions"][DRACO] for primitive in primitives if DRACO in _extensions(primitive)),
    ]
    return [_Reference(holder, "bufferView") for holder in holders]


def _extensions(entry: Item) -> Item:
    extensions = entry.get("extensions")
    return extensions if isinstance(extensions, dict) else {}
