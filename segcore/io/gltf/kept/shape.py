"""Checks the members of a glTF document that are followed when it is changed, before anything is changed."""

from collections.abc import Iterator

from segcore.errors import InvalidMesh
from segcore.io.gltf.compression.draco import DRACO
from segcore.io.gltf.compression.meshopt import MESHOPT
from segcore.io.gltf.document import Document, Item, indices, integer, member
from segcore.io.gltf.scene import INSTANCING

_LISTS = (
    "accessors", "animations", "bufferViews", "buffers", "images", "materials", "meshes", "nodes", "samplers", "scenes",
    "skins", "textures",
)  # fmt: skip
_VARIANTS = "KHR_materials_variants"


def check_members(document: Document) -> None:
    """Check that references are whole numbers, and lists and objects are what they must be.

    Raises
    ------
    InvalidMesh
        If one is something else; the message names it.
    """
    root = document.root
    for name in _LISTS:
        _objects(root, name, "the top level")
        for i in range(document.count(name)):
            _extensions(document.item(name, i), f"{name}[{i}]")
    _names(root, "extensionsUsed")
    _names(root, "extensionsRequired")
    variants = _extensions(root, "the top level").get(_VARIANTS, {})
    _objects(variants, "variants", f"extensions.{_VARIANTS}")
    for i in range(document.count("meshes")):
        _check_mesh(document.item("meshes", i), f"meshes[{i}]")
    for name, keys in _REFERENCES.items():
        for i in range(document.count(name)):
            _check_numbers(document.item(name, i), keys, f"{name}[{i}]")
    for i in range(document.count("nodes")):
        _check_node(document.item("nodes", i), f"nodes[{i}]")
    for i in range(document.count("skins")):
        indices(document.item("skins", i), "joints", f"skins[{i}]")
    for i in range(document.count("animations")):
        _check_animation(document.item("animations", i), f"animations[{i}]")
    _check_data(document)


_REFERENCES = {
    "accessors": ("bufferView",),
    "images": ("bufferView",),
    "nodes": ("mesh", "skin"),
    "skins": ("inverseBindMatrices", "skeleton"),
    "textures": ("source", "sampler"),
}


def _check_mesh(mesh: Item, where: str) -> None:
    for i, primitive in enumerate(_objects(mesh, "primitives", where)):
        name = f"{where}.primitives[{i}]"
        _check_numbers(primitive, ("indices", "material"), name)
        _all_numbers(member(primitive, "attributes", name), f"{name}.attributes")
        for target in _objects(primitive, "targets", name):
            _all_numbers(target, f"{name}.targets")
        extensions = _extensions(primitive, name)
        _objects(extensions.get(_VARIANTS, {}), "mappings", f"{name}.extensions.{_VARIANTS}")
        if DRACO in extensions:
            integer(extensions[DRACO], "bufferView", f"{name}.extensions.{DRACO}")
            member(extensions[DRACO], "attributes", f"{name}.extensions.{DRACO}")


def _check_node(node: Item, where: str) -> None:
    copies = _extensions(node, where).get(INSTANCING)
    if copies is not None:
        where = f"{where}.extensions.{INSTANCING}"
        _all_numbers(member(copies, "attributes", where), f"{where}.attributes")


def _check_animation(animation: Item, where: str) -> None:
    samplers = _objects(animation, "samplers", where)
    for sampler in samplers:
        for key in ("input", "output"):
            integer(sampler, key, f"{where}.samplers")
    for channel in _objects(animation, "channels", where):
        _check_numbers(member(channel, "target", f"{where}.channels"), ("node",), f"{where}.channels.target")
        if integer(channel, "sampler", f"{where}.channels") >= len(samplers):
            raise InvalidMesh(f"{where}.channels of the glTF file refers to a sampler that it does not have.")


def _check_data(document: Document) -> None:
    for i in range(document.count("accessors")):
        entry = document.item("accessors", i)
        if "sparse" in entry:
            sparse = member(entry, "sparse", f"accessors[{i}]")
            for key in ("indices", "values"):
                integer(member(sparse, key, f"accessors[{i}].sparse"), "bufferView", f"accessors[{i}].sparse.{key}")
    for where, place in _places(document):
        buffer = document.item("buffers", integer(place, "buffer", where))
        end = integer(place, "byteOffset", where, 0) + integer(place, "byteLength", where)
        if end > integer(buffer, "byteLength", "buffers"):
            raise InvalidMesh(f"{where} of the glTF file reaches beyond its buffer.")


def _places(document: Document) -> Iterator[tuple[str, Item]]:
    for i in range(document.count("bufferViews")):
        view, where = document.item("bufferViews", i), f"bufferViews[{i}]"
        yield where, view
        codecs = [name for name in view.get("extensions", {}) if name in MESHOPT]
        yield from ((f"{where}.extensions.{name}", view["extensions"][name]) for name in codecs)


def _objects(item: Item, key: str, where: str) -> list[Item]:
    """The member ``key``: a list of objects, empty if it is missing."""
    entries = item.get(key, [])
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InvalidMesh(f"{key} of {where} of the glTF file must be a list of objects.")
    return entries


def _extensions(item: Item, where: str) -> Item:
    extensions = item.get("extensions", {})
    if not isinstance(extensions, dict) or not all(isinstance(entry, dict) for entry in extensions.values()):
        raise InvalidMesh(f"extensions of {where} of the glTF file must be an object of objects.")
    return extensions


def _names(root: Item, key: str) -> None:
    names = root.get(key, [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InvalidMesh(f"{key} of the glTF file must be a list of names.")


def _check_numbers(item: Item, keys: tuple[str, ...], where: str) -> None:
    for key in keys:
        if key in item:
            integer(item, key, where)


def _all_numbers(item: Item, where: str) -> None:
    _check_numbers(item, tuple(item), where)
