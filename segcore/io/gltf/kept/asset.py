"""KeptAsset: a glTF document that is being changed, with all of its buffers and pictures, to be written as GLB."""

import json
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh
from segcore.io.gltf.compression.meshopt import MESHOPT
from segcore.io.gltf.document import Document, Item
from segcore.io.gltf.glb_file import GlbFile
from segcore.io.gltf.kept.pictures import embedded_picture
from segcore.io.gltf.kept.ranges import Ranges

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
COMPONENT_CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_ALIGNMENT = 16  # bytes: a range keeps its place within this many, so that all numbers in it stay aligned
_WORD = 4  # bytes, of which the rows of attributes are a multiple


@dataclass(slots=True, eq=False)
class KeptAsset:
    """A copy of a document. Buffers are those of the input, then one for each view that was added."""

    root: Item
    buffers: list[memoryview | None]  # None for a buffer without data, which compressed views need as a fallback
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, document: Document) -> "KeptAsset":
        """Return a copy of a document whose pictures are all buffer views.

        Raises
        ------
        InvalidMesh, UnsupportedFormat
            If a buffer is damaged or missing, or the JSON has numbers that are not finite.
        """
        root = _copied(document.root)
        buffers = [_data(document, index) for index in range(document.count("buffers"))]
        asset = cls(root, buffers)
        for index in range(document.count("images")):
            asset._embed(document, index)
        return asset

    def entries(self, name: str) -> list[Any]:
        """Return an array of the top level, which is created if the document has none."""
        entries = self.root.setdefault(name, [])
        return entries if isinstance(entries, list) else []

    def add(self, name: str, entry: Item) -> int:
        """Append an entry to an array of the top level and return its number."""
        entries = self.entries(name)
        entries.append(entry)
        return len(entries) - 1

    def add_view(self, data: memoryview, **properties: object) -> int:
        """Append bytes as a buffer view and return its number."""
        self.buffers.append(data)
        view = {"buffer": len(self.buffers) - 1, "byteOffset": 0, "byteLength": len(data), **properties}
        return self.add("bufferViews", view)

    def add_indices(self, corners: NDArray[np.unsignedinteger[Any]]) -> int:
        """Append an accessor of indices and return its number."""
        view = self.add_view(_bytes(corners), target=ELEMENT_ARRAY_BUFFER)
        code = COMPONENT_CODES[corners.dtype.str[1:]]
        return self.add(
            "accessors", {"bufferView": view, "componentType": code, "type": "SCALAR", "count": corners.size}
        )

    def add_rows(self, values: NDArray[Any], *, is_attribute: bool) -> int:
        """Append the (count, width) numbers of an accessor as a buffer view and return its number."""
        rows = np.ascontiguousarray(values)
        size = rows.shape[1] * rows.dtype.itemsize
        if not is_attribute:
            return self.add_view(_bytes(rows))
        padded = np.zeros((len(rows), -(-size // _WORD) * _WORD), np.uint8)
        padded[:, :size] = rows.view(np.uint8).reshape(len(rows), size)
        more = {"byteStride": padded.shape[1]} if padded.shape[1] != size else {}
        return self.add_view(_bytes(padded), target=ARRAY_BUFFER, **more)

    def use_extension(self, name: str) -> None:
        used = self.entries("extensionsUsed")
        if name not in used:
            used.append(name)

    def drop_extension(self, name: str) -> None:
        """Remove an extension from the lists of those that are used and required."""
        for key in ("extensionsUsed", "extensionsRequired"):
            if name in self.root.get(key, []):
                self.root[key].remove(name)
            if self.root.get(key) == []:
                del self.root[key]

    def write(self, target: IO[bytes]) -> None:
        """Write the asset as GLB, once, with the bytes of its buffers that a view refers to.

        Raises
        ------
        LimitExceeded
            If it would be larger than the 4 GiB of the format.
        """
        blobs = self._pack()
        GlbFile(self.root, blobs).write(target)

    def _embed(self, document: Document, index: int) -> None:
        image = self.root["images"][index]
        if "bufferView" in image or not isinstance(image.get("uri"), str):
            return
        picture = embedded_picture(image, document.companions, f"images[{index}]")
        if isinstance(picture, str):
            self.notes.append(picture)
            return
        if picture.name and "name" not in image:
            image["name"] = picture.name
        del image["uri"]
        image |= {"mimeType": picture.media_type, "bufferView": self.add_view(memoryview(picture.data))}

    def _pack(self) -> list[NDArray[Any]]:
        """Move the used bytes of all buffers into one; return its pieces, and change the buffers and views."""
        places = [place for view in self.root.get("bufferViews", []) for place in _places(view)]
        needed = [Ranges() for _ in self.buffers]
        for place in places:
            needed[place["buffer"]].add(place.get("byteOffset", 0), place["byteLength"])
        blobs: list[NDArray[Any]] = []
        size = 0
        starts: list[dict[int, int]] = []  # by buffer, the new place of each range
        for data, ranges in zip(self.buffers, needed, strict=True):
            starts.append({})
            if data is None:
                continue
            for begin, end in ranges.merged():
                gap = (begin - size) % _ALIGNMENT
                blobs += [np.zeros(gap, np.uint8), np.frombuffer(data[begin:end], np.uint8)]
                starts[-1][begin] = size + gap
                size += gap + end - begin
        blobs.append(np.zeros(-size % _WORD, np.uint8))
        size += -size % _WORD
        without_data = self._buffers_without_data(places, has_data=size > 0)
        for place in places:
            source, offset = place["buffer"], place.get("byteOffset", 0)
            if self.buffers[source] is None:
                place["buffer"] = without_data[source]
                continue
            begin = needed[source].start_of(offset)
            place |= {"buffer": 0, "byteOffset": starts[source][begin] + offset - begin}
        if size:
            self.root["buffers"].insert(0, {"byteLength": size})
        if not self.root["buffers"]:
            del self.root["buffers"]
        return [blob for blob in blobs if blob.size]

    def _buffers_without_data(self, places: list[Item], *, has_data: bool) -> dict[int, int]:
        """Leave only the buffers without data that a view refers to; return their new numbers."""
        used = sorted({place["buffer"] for place in places if self.buffers[place["buffer"]] is None})
        old = self.entries("buffers")
        self.root["buffers"] = [old[index] for index in used]
        return {index: number + has_data for number, index in enumerate(used)}


def _bytes(values: NDArray[Any]) -> memoryview:
    return np.ascontiguousarray(values).reshape(-1).view(np.uint8).data


def _copied(root: Item) -> Item:
    try:
        copy: Item = json.loads(json.dumps(root, allow_nan=False))
    except ValueError as error:
        raise InvalidMesh(
            "The JSON of the glTF file has a number that is not finite: export the file again."
        ) from error
    return copy


def _data(document: Document, index: int) -> memoryview | None:
    entry = document.item("buffers", index)
    has_own = index == 0 and document.binary is not None
    if "uri" not in entry and not has_own and any(name in entry.get("extensions", {}) for name in MESHOPT):
        return None
    return document.buffer(index)


def _places(view: Item) -> list[Item]:
    """The members of a view that refer to bytes of a buffer: itself, and its compressed form."""
    extensions = view.get("extensions", {})
    return [view, *(extensions[name] for name in MESHOPT if name in extensions)]
