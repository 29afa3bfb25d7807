"""The JSON and the buffers of a glTF 2.0 asset; each value is checked when it is read."""

import base64
import binascii
import json
import math
import struct
from dataclasses import dataclass, field
from typing import Any, NoReturn

from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.file_sets import Companions, NoCompanions

_MAGIC, _HEADER, _CHUNK_HEADER = b"glTF", 12, 8
_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"
_LARGEST = 2**53  # integers up to here are exact in JSON readers that use float64
# Extensions for the look or the meaning of faces, not for their positions.
_HARMLESS = (
    "EXT_instance_features", "EXT_lights_", "EXT_mesh_features", "EXT_structural_metadata", "EXT_texture_",
    "KHR_animation_pointer", "KHR_lights_", "KHR_materials_", "KHR_technique", "KHR_texture_", "KHR_xmp",
    "MSFT_texture_dds",
)  # fmt: skip
_UNDERSTOOD = (
    "KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
)  # fmt: skip

Item = dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """A parsed asset; ``name`` in its methods is a member of the top level, such as ``accessors``."""

    root: Item
    binary: memoryview | None  # the BIN chunk of a GLB file
    size: int  # bytes of the whole file
    companions: Companions = field(default_factory=NoCompanions)  # the files of the buffers
    _buffers: dict[int, memoryview] = field(default_factory=dict)  # decoded once

    def item(self, name: str, index: int) -> Item:
        """Return entry ``index`` of an array of the top level."""
        entries = self.root.get(name, [])
        if not isinstance(entries, list) or not 0 <= index < len(entries) or not isinstance(entries[index], dict):
            raise InvalidMesh(f"The glTF file refers to {name}[{index}], which it does not have.")
        entry: Item = entries[index]
        return entry

    def count(self, name: str) -> int:
        entries = self.root.get(name, [])
        return len(entries) if isinstance(entries, list) else 0

    def buffer(self, index: int) -> memoryview:
        """Return the bytes of a buffer, which must be inside the file or in one that belongs to it.

        Raises
        ------
        UnsupportedFormat
            If the buffer is another file.
        InvalidMesh
            If it is damaged or too short.
        """
        if index not in self._buffers:
            self._buffers[index] = self._read_buffer(index)
        return self._buffers[index]

    def _read_buffer(self, index: int) -> memoryview:
        entry, where = self.item("buffers", index), f"buffers[{index}]"
        length = integer(entry, "byteLength", where)
        uri = entry.get("uri")
        if uri is None and index == 0 and self.binary is not None:
            data = self.binary
        elif isinstance(uri, str):
            companion = None if uri.startswith("data:") else self.companions.read(uri)
            data = memoryview(_data_uri(uri, where) if companion is None else companion)
        else:
            raise InvalidMesh(f"{where} of the glTF file has no data: it is cut short or its compression is optional.")
        if len(data) < length:
            raise InvalidMesh(
                f"{where} of the glTF file should have {length} bytes and has {len(data)}: it is cut short."
            )
        return data[:length]


def read_document(data: bytes, companions: Companions | None = None) -> Document:
    """Parse a GLB or a glTF file, with the files that belong to it.

    Raises
    ------
    InvalidMesh
        If it is damaged or cut short.
    UnsupportedFormat
        If it has another version, or requires an unknown extension that changes its geometry; the message names it.
    """
    text, binary = _split_container(data) if data.startswith(_MAGIC) else (data, None)
    root = _parse(text)
    asset = root.get("asset")
    version = asset.get("version") if isinstance(asset, dict) else None
    if not isinstance(version, str | int | float):
        raise InvalidMesh("The file is JSON, but not glTF: it has no asset.version.")
    if str(version).partition(".")[0] != "2":
        raise UnsupportedFormat(f"glTF version {str(version)[:20]!r} cannot be read: save it as glTF 2.0.")
    _check_extensions(root.get("extensionsRequired", []))
    return Document(root, binary, len(data), companions or NoCompanions())


def view_bytes(document: Document, index: int) -> memoryview:
    """Return the bytes of a buffer view."""
    entry, where = document.item("bufferViews", index), f"bufferViews[{index}]"
    begin, length = integer(entry, "byteOffset", where, 0), integer(entry, "byteLength", where)
    buffer = document.buffer(integer(entry, "buffer", where))
    if begin + length > len(buffer):
        raise InvalidMesh(f"{where} of the glTF file reaches beyond its buffer of {len(buffer)} bytes.")
    return buffer[begin : begin + length]


def integer(item: Item, key: str, where: str, default: int | None = None) -> int:
    """Return the member ``key``: a whole number from 0 to 2**53."""
    value = item.get(key, default)
    if type(value) is not int or not 0 <= value <= _LARGEST:
        _refuse(where, key, f"a whole number from 0 to {_LARGEST}")
    return value


def numbers(item: Item, key: str, where: str, default: list[float]) -> list[float]:
    """Return the member ``key``: as many finite numbers as ``default`` has."""
    values = item.get(key, default)
    if not isinstance(values, list) or len(values) != len(default) or not all(_is_finite(value) for value in values):
        _refuse(where, key, f"{len(default)} finite numbers")
    return [float(value) for value in values]


def number_list(item: Item, key: str, where: str) -> tuple[float, ...]:
    """Return the member ``key``: a list of finite numbers, empty if it is missing."""
    values = item.get(key, [])
    if not isinstance(values, list) or not all(_is_finite(value) for value in values):
        _refuse(where, key, "a list of finite numbers")
    return tuple(float(value) for value in values)


def indices(item: Item, key: str, where: str) -> list[int]:
    """Return the member ``key``: a list of whole numbers from 0 to 2**53, empty if it is missing."""
    values = item.get(key, [])
    if not isinstance(values, list) or not all(type(value) is int and 0 <= value <= _LARGEST for value in values):
        _refuse(where, key, f"a list of whole numbers from 0 to {_LARGEST}")
    return values


def member(item: Item, key: str, where: str) -> Item:
    """Return the member ``key``: an object."""
    value = item.get(key)
    if not isinstance(value, dict):
        _refuse(where, key, "an object")
    return value


def _refuse(where: str, key: str, form: str) -> NoReturn:
    raise InvalidMesh(f"{where}.{key} of the glTF file must be {form}.")


def _is_finite(value: object) -> bool:
    return (type(value) is float and math.isfinite(value)) or (type(value) is int and abs(value) <= _LARGEST)


def _split_container(data: bytes) -> tuple[bytes, memoryview | None]:
    if len(data) < _HEADER:
        raise InvalidMesh("The GLB file ends within its header: it is cut short.")
    _, version, length = struct.unpack_from("<4sII", data)
    if version != 2:
        raise UnsupportedFormat(f"GLB version {version} cannot be read: save it as glTF 2.0.")
    if length > len(data):
        raise InvalidMesh(f"The GLB file should have {length} bytes and has {len(data)}: it is cut short.")
    chunks = _chunks(memoryview(data)[:length])
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise InvalidMesh("The GLB file does not begin with a JSON chunk: it is damaged.")
    binary = next((chunk for kind, chunk in chunks[1:] if kind == _BINARY_CHUNK), None)
    return bytes(chunks[0][1]), binary


def _chunks(data: memoryview) -> list[tuple[bytes, memoryview]]:
    chunks, at = [], _HEADER
    while at < len(data):
        if at + _CHUNK_HEADER > len(data):
            raise InvalidMesh(f"Byte {at}: the GLB file ends within the header of a chunk: it is damaged.")
        length, kind = struct.unpack_from("<I4s", data, at)
        begin = at + _CHUNK_HEADER
        at = begin + length
        if at > len(data):
            raise InvalidMesh(f"Byte {begin}: a chunk of the GLB file is longer than the file: it is damaged.")
        chunks.append((kind, data[begin:at]))
    return chunks


def _parse(text: bytes) -> Item:
    try:
        root = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidMesh("The JSON of the glTF file is damaged or cut short.") from error
    if not isinstance(root, dict):
        raise InvalidMesh("The JSON of the glTF file is not an object.")
    return root


def _check_extensions(required: object) -> None:
    if not isinstance(required, list) or not all(isinstance(name, str) for name in required):
        raise InvalidMesh("extensionsRequired of the glTF file must be a list of names.")
    for name in required:
        if not _is_known(name):
            raise UnsupportedFormat(
                f"The glTF file requires the extension {name[:60]!r}: save it without that extension."
            )


def has_unknown_extensions(root: Item) -> bool:
    """Return whether a document uses an extension of which it is not known what it refers to."""
    used = root.get("extensionsUsed", [])
    return not isinstance(used, list) or not all(isinstance(name, str) and _is_known(name) for name in used)


def _is_known(extension: str) -> bool:
    return extension.startswith(_HARMLESS + _UNDERSTOOD)


def _data_uri(uri: str, where: str) -> bytes:
    head, comma, body = uri.partition(",")
    if not head.startswith("data:") or not comma:
        raise UnsupportedFormat(
            f"{where} of the glTF file is another file, {uri[:80]!r}, which is not here: send both in a ZIP archive or "
            "save the model as GLB."
        )
    if not head.endswith(";base64"):
        raise UnsupportedFormat(f"{where} of the glTF file is a data URI in another encoding than base64.")
    try:
        return base64.b64decode(body, validate=True)
    except (binascii.Error, ValueError) as error:
        raise InvalidMesh(f"{where} of the glTF file is not valid base64: it is damaged or cut short.") from error
