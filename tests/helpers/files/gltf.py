"""glTF assets composed by hand or by Hypothesis."""

import base64
import json
import struct
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

FLOAT, UNSIGNED = 5126, {1: 5121, 2: 5123, 4: 5125}
SIZES = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


@dataclass
class Asset:
    """A glTF document that is being composed, and its one buffer."""

    document: dict[str, Any] = field(
        default_factory=lambda: {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        }
    )
    binary: bytes = b""
    fallbacks: list[dict[str, Any]] = field(default_factory=list)  # buffers without data

    def add(self, name: str, entry: dict[str, Any]) -> int:
        self.document[name].append(entry)
        return len(self.document[name]) - 1

    def view(self, rows: list[tuple[float, ...]], component: int, gap: int = 0) -> int:
        """Add a buffer view of the rows with ``gap`` unused bytes between them."""
        self.binary += b"\xee" * (-len(self.binary) % 4)
        data = (b"\xee" * gap).join(struct.pack(f"<{len(row)}{SIZES[component]}", *row) for row in rows)
        entry = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if gap:
            entry["byteStride"] = gap + struct.calcsize(f"<{len(rows[0])}{SIZES[component]}")
        self.binary += data
        return self.add("bufferViews", entry)

    def accessor(self, rows: list[tuple[float, ...]], component: int, gap: int = 0, **more: object) -> int:
        kind = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[len(rows[0])]
        view = self.view(rows, component, gap)
        entry = {"bufferView": view, "componentType": component, "count": len(rows), "type": kind, **more}
        return self.add("accessors", entry)

    def primitive(
        self, positions: int, indices: list[int] | None = None, mode: int | None = None, width: int = 2
    ) -> dict:
        entry: dict[str, Any] = {"attributes": {"POSITION": positions}}
        if indices is not None:
            entry["indices"] = self.accessor([(i,) for i in indices], UNSIGNED[width])
        if mode is not None:
            entry["mode"] = mode
        return entry

    def root(self, **node: object) -> int:
        index = self.add("nodes", node)
        self.document["scenes"][0]["nodes"].append(index)
        return index

    def glb(self) -> bytes:
        text = json.dumps({**self.document, "buffers": [{"byteLength": len(self.binary)}, *self.fallbacks]}).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def gltf(self) -> bytes:
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        return json.dumps({**self.document, "buffers": [{"byteLength": len(self.binary), "uri": uri}]}).encode()


small = st.floats(-100, 100, width=32, allow_subnormal=False)
points = st.lists(st.tuples(small, small, small), min_size=1, max_size=8)


@st.composite
def positions(draw: st.DrawFn, asset: Asset) -> tuple[int, int]:
    """An accessor of positions of any type of glTF, and the number of positions."""
    rows = draw(points)
    gap = draw(st.sampled_from([0, 0, 4]))
    if draw(st.booleans()):
        component = draw(st.sampled_from(list(LARGEST)))
        least = -LARGEST[component] - 1 if component in (5120, 5122) else 0
        value = st.integers(least, LARGEST[component])
        rows = [draw(st.tuples(value, value, value)) for _ in rows]
        return asset.accessor(rows, component, gap, normalized=draw(st.booleans())), len(rows)
    accessor = asset.accessor(rows, FLOAT, gap)
    if draw(st.booleans()):
        places = sorted(draw(st.sets(st.integers(0, len(rows) - 1), min_size=1)))
        values = [draw(st.tuples(small, small, small)) for _ in places]
        asset.document["accessors"][accessor]["sparse"] = {
            "count": len(places),
            "indices": {"bufferView": asset.view([(place,) for place in places], 5121), "componentType": 5121},
            "values": {"bufferView": asset.view(values, FLOAT)},
        }
        if draw(st.booleans()):
            del asset.document["accessors"][accessor]["bufferView"]
    return accessor, len(rows)


@st.composite
def primitives(draw: st.DrawFn, asset: Asset) -> dict[str, Any]:
    accessor, count = draw(positions(asset))
    mode = draw(st.sampled_from([None, 4, 5, 6, 1]))
    indices = draw(st.lists(st.integers(0, count - 1), min_size=3, max_size=9))
    if mode in (None, 4):
        indices = indices[: len(indices) // 3 * 3]
    whole = mode in (5, 6) or count % 3 == 0
    return asset.primitive(
        accessor, None if whole and draw(st.booleans()) else indices, mode, draw(st.sampled_from([1, 2, 4]))
    )


@st.composite
def transforms(draw: st.DrawFn) -> dict[str, Any]:
    factor = st.floats(0.25, 4).flatmap(lambda value: st.sampled_from([value, -value]))
    kind = draw(st.sampled_from(["none", "parts", "matrix"]))
    if kind == "none":
        return {}
    if kind == "matrix":
        columns = [[*(draw(factor) if i == k else 0.5 for k in range(3)), 0.0] for i in range(3)]
        return {"matrix": [*columns[0], *columns[1], *columns[2], draw(small), draw(small), draw(small), 1.0]}
    turn = draw(st.sampled_from([[0, 0, 0, 1], [0.6, 0, 0, 0.8], [0.5, -0.5, 0.5, -0.5], [0, 0.28, 0.96, 0]]))
    parts = {
        "translation": [draw(small), draw(small), draw(small)],
        "rotation": turn,
        "scale": [draw(factor), draw(factor), draw(factor)],
    }
    return {name: parts[name] for name in draw(st.sets(st.sampled_from(list(parts))))}


@st.composite
def assets(draw: st.DrawFn) -> Asset:
    """Meshes of several primitives at several nodes of a forest."""
    asset = Asset()
    for _ in range(draw(st.integers(1, 2))):
        asset.add("meshes", {"primitives": [draw(primitives(asset)) for _ in range(draw(st.integers(1, 3)))]})
    count = draw(st.integers(1, 5))
    for node in range(count):
        entry = draw(transforms())
        if draw(st.booleans()) or node == 0:
            entry["mesh"] = draw(st.integers(0, len(asset.document["meshes"]) - 1))
        parent = draw(st.integers(-1, node - 1))
        index = asset.root(**entry) if parent < 0 else asset.add("nodes", entry)
        if parent >= 0:
            asset.document["nodes"][parent].setdefault("children", []).append(index)
    return asset
