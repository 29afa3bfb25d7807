"""glTF assets that the reference encoders of meshoptimizer and Draco compressed."""

import base64
import json
from pathlib import Path

import numpy as np

from helpers.files.gltf import Asset
from segcore import shapes

DRACO = "KHR_draco_mesh_compression"
SAMPLES = json.loads((Path(__file__).parents[1] / "node" / "meshopt" / "samples.json").read_text())
ENCODED = {name: base64.b64decode(data) for name, data in SAMPLES["encoded"].items()}
DECODED = {name: base64.b64decode(data) for name, data in SAMPLES["decoded"].items()}
"""The contents according to the reference decoder."""
POSITIONS = np.array(SAMPLES["positions"]).reshape(-1, 3)
FACES = np.array(SAMPLES["indices"]).reshape(-1, 3)


def compressed_view(asset: Asset, data: bytes, count: int, stride: int, extension: str, **more: str) -> int:
    """A buffer view that is stored compressed in another one."""
    source = asset.document["bufferViews"][asset.view([(byte,) for byte in data], 5121)]
    entry = {"buffer": 0, "byteOffset": source["byteOffset"], "byteLength": len(data), "byteStride": stride}
    return asset.add(
        "bufferViews",
        {"buffer": 1, "byteLength": count * stride, "extensions": {extension: {**entry, "count": count, **more}}},
    )


def meshopt_asset(
    positions: str = "positions_0", corners: str = "triangles", extension: str = "EXT_meshopt_compression", **more: str
) -> Asset:
    asset = Asset()
    mode = "TRIANGLES" if corners == "triangles" else "INDICES"
    views = [
        compressed_view(asset, ENCODED[positions], len(POSITIONS), 12, extension, mode="ATTRIBUTES", **more),
        compressed_view(asset, ENCODED[corners], FACES.size, 4, extension, mode=mode),
    ]
    asset.fallbacks = [
        {"byteLength": 12 * len(POSITIONS) + 4 * FACES.size, "extensions": {extension: {"fallback": True}}}
    ]
    for view, kind, component, count in (
        (views[0], "VEC3", 5126, len(POSITIONS)),
        (views[1], "SCALAR", 5125, FACES.size),
    ):
        asset.add("accessors", {"bufferView": view, "type": kind, "componentType": component, "count": count})
    asset.add("meshes", {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]})
    asset.root(mesh=0)
    asset.document["extensionsRequired"] = [extension]
    return asset


def draco_asset(data: bytes | None = None) -> tuple[Asset, bytes]:
    """An asset with one compressed primitive, and its Draco data."""
    import DracoPy

    mesh = shapes.icosphere(2)
    data = data or DracoPy.encode(mesh.vertices.astype("f4"), mesh.faces.astype("u4"), quantization_bits=16)
    decoded = DracoPy.decode(data)
    asset = Asset()
    view = asset.view([(byte,) for byte in data], 5121)
    for kind, component, count in (("VEC3", 5126, len(decoded.points)), ("SCALAR", 5125, decoded.faces.size)):
        asset.add("accessors", {"componentType": component, "type": kind, "count": count})
    primitive = {
        "attributes": {"POSITION": 0},
        "indices": 1,
        "extensions": {DRACO: {"bufferView": view, "attributes": {"POSITION": 0}}},
    }
    asset.add("meshes", {"primitives": [primitive]})
    asset.root(mesh=0)
    asset.document |= {"extensionsUsed": [DRACO], "extensionsRequired": [DRACO]}
    return asset, data
