"""A glTF asset with everything that an output must keep: skin, morph target, animation, pictures, copies, extras."""

import base64
import struct
import zlib
from typing import Any

from helpers.files.gltf import FLOAT, Asset

UNSIGNED_BYTE = 5121
UNKNOWN, LIGHTS = "VENDOR_thing", "KHR_lights_punctual"
INSTANCING, VARIANTS = "EXT_mesh_gpu_instancing", "KHR_materials_variants"
SIDE = 4  # quads along a side of the grid
SHIFTS = [(0.0, 0.0, 0.0), (6.0, 0.0, 0.0), (12.0, 0.0, 0.0)]  # of the copies
BODY, TWIN_A, TWIN_B, COPIES, ELSEWHERE, ROOT, JOINT, STRIP = range(8)  # nodes


def png(*pixels: tuple[int, int, int]) -> bytes:
    """A picture of one row."""
    row = b"\0" + b"".join(map(bytes, pixels))
    parts = (
        (b"IHDR", struct.pack(">IIBBBBB", len(pixels), 1, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(row)),
        (b"IEND", b""),
    )
    chunks = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


RED, BLUE = png((200, 30, 30), (250, 240, 30)), png((30, 30, 200), (30, 200, 200))


def grid(asset: Asset) -> dict[str, Any]:
    """A primitive of 2 * SIDE * SIDE faces with normals and texture coordinates."""
    places = [(x, y) for x in range(SIDE + 1) for y in range(SIDE + 1)]
    points = [(float(x), float(y), 0.5 * ((x * y) % 3)) for x, y in places]
    corners = [
        x * (SIDE + 1) + y + step
        for x in range(SIDE)
        for y in range(SIDE)
        for step in (0, SIDE + 1, SIDE + 2, 0, SIDE + 2, 1)
    ]
    bounds = {
        "min": [min(axis) for axis in zip(*points, strict=True)],
        "max": [max(axis) for axis in zip(*points, strict=True)],
    }
    primitive = asset.primitive(asset.accessor(points, FLOAT, **bounds), corners)
    primitive["attributes"]["NORMAL"] = asset.accessor([(0.0, 0.0, 1.0)] * len(points), FLOAT)
    primitive["attributes"]["TEXCOORD_0"] = asset.accessor([(x / SIDE, y / SIDE) for x, y in places], FLOAT)
    return primitive


def rich_asset() -> Asset:
    """The asset; its pictures are a buffer view and a data URI."""
    asset = Asset()
    document = asset.document
    _add_materials(asset)
    body = grid(asset) | {"material": 0, "extras": {"made by": "hand"}}
    count = (SIDE + 1) ** 2
    joints = [(0, 1, 0, 0)] * count
    weights = [(0.75, 0.25, 0.0, 0.0)] * count
    body["attributes"] |= {
        "JOINTS_0": asset.accessor(joints, UNSIGNED_BYTE),
        "WEIGHTS_0": asset.accessor(weights, FLOAT),
    }
    body["targets"] = [{"POSITION": asset.accessor([(0.0, 0.0, 1.0)] * count, FLOAT, min=[0, 0, 1], max=[0, 0, 1])}]
    points = {"attributes": {"POSITION": body["attributes"]["POSITION"]}, "targets": body["targets"], "mode": 0}
    asset.add(
        "meshes", {"name": "body", "primitives": [body, points], "weights": [0.5], "extras": {"targetNames": ["up"]}}
    )
    asset.add("meshes", {"name": "twin", "primitives": [grid(asset) | {"material": 1}, grid(asset)]})
    strip = {
        "attributes": {
            "POSITION": asset.accessor(
                [(float(i // 2), float(i % 2), 8.0) for i in range(8)], FLOAT, min=[0, 0, 8], max=[3, 1, 8]
            )
        },
        "mode": 5,
    }
    asset.add("meshes", {"name": "strip", "primitives": [strip]})
    _add_nodes(asset)
    _add_animation(asset)
    document["scene"] = 0
    document["scenes"] += [{"name": "other", "nodes": [ELSEWHERE]}]
    document["scenes"][0]["extras"] = {"of": "the scene"}
    document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    document["extensions"] = {LIGHTS: {"lights": [{"type": "point"}]}, UNKNOWN: {"value": 3}}
    document["extensionsUsed"] = [LIGHTS, INSTANCING]
    document["asset"] |= {"generator": "a test", "copyright": "nobody"}
    return asset


def _add_materials(asset: Asset) -> None:
    view = asset.view([(byte,) for byte in RED], UNSIGNED_BYTE)
    uri = "data:image/png;base64," + base64.b64encode(BLUE).decode()
    asset.document |= {
        "images": [{"bufferView": view, "mimeType": "image/png", "name": "red"}, {"uri": uri}],
        "samplers": [{"magFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
        "materials": [
            {"name": "paint", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "extras": {"shop": "no. 5"}},
            {"name": "steel", "emissiveTexture": {"index": 1}, "doubleSided": True},
        ],
        "skins": [{"joints": [ROOT, JOINT], "skeleton": ROOT}],
        "animations": [],
    }


def _add_nodes(asset: Asset) -> None:
    asset.root(name="Body of it", mesh=0, skin=0, extras={"id": 7})
    asset.root(name="a.b:c", mesh=1, translation=[0, 10, 0])
    asset.root(name="twin", mesh=1, translation=[10, 10, 0], scale=[-1, 1, 1], camera=0)
    copies = {"TRANSLATION": asset.accessor(SHIFTS, FLOAT), "_ID": asset.accessor([(4.0,), (5.0,), (6.0,)], FLOAT)}
    asset.root(name="row", mesh=1, translation=[0, 20, 0], extensions={INSTANCING: {"attributes": copies}})
    asset.add("nodes", {"name": "elsewhere", "mesh": 1})
    asset.root(name="root", children=[JOINT], extensions={LIGHTS: {"light": 0}})
    asset.add("nodes", {"name": "joint", "translation": [0, 1, 0]})
    asset.root(name="strip", mesh=2)


def _add_animation(asset: Asset) -> None:
    times = asset.accessor([(0.0,), (1.0,)], FLOAT, min=[0], max=[1])
    places = asset.accessor([(0.0, 1.0, 0.0), (0.0, 1.0, 5.0)], FLOAT)
    weights = asset.accessor([(0.0,), (1.0,)], FLOAT)
    channels = [(0, JOINT, "translation"), (1, BODY, "weights"), (0, TWIN_B, "translation")]
    asset.document["animations"] = [
        {
            "name": "wave",
            "samplers": [{"input": times, "output": places}, {"input": times, "output": weights}],
            "channels": [{"sampler": s, "target": {"node": node, "path": path}} for s, node, path in channels],
        }
    ]
