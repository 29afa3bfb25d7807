"""glTF with Draco: what the decoder of another program makes of it, or a clear refusal."""

import sys

import numpy as np
import pytest
from gltf_files import Asset
from soups import read, read_or_none

from segcore import shapes
from segcore.errors import InvalidMesh, UnsupportedFormat

DracoPy = pytest.importorskip("DracoPy")
DRACO = "KHR_draco_mesh_compression"


def compressed(data: bytes | None = None) -> tuple[Asset, bytes]:
    """An asset of which the one primitive is compressed, and the Draco data in it."""
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


def test_the_triangles_are_those_of_the_decoder_in_its_order() -> None:
    asset, data = compressed()
    mesh, decoded = read(asset.glb()), DracoPy.decode(data)
    assert mesh.vertices.tolist() == decoded.points.tolist()
    assert mesh.faces.tolist() == decoded.faces.tolist()


def test_the_shape_is_the_one_that_was_compressed() -> None:
    asset, _ = compressed()
    box = shapes.icosphere(2)
    ours, theirs = (np.sort(corners.mean(axis=1), axis=0) for corners in (read(asset.glb()).corners, box.corners))
    np.testing.assert_allclose(ours, theirs, atol=1e-4 * np.ptp(box.vertices))


def test_counts_that_contradict_the_data_are_refused() -> None:
    asset, _ = compressed()
    for accessor in (0, 1):
        asset.document["accessors"][accessor]["count"] += 3
        with pytest.raises(InvalidMesh, match=r"accessors\[\d\], which should have"):
            read(asset.glb())


def test_without_the_decoder_the_extension_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    asset, _ = compressed()
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(UnsupportedFormat, match=rf"{DRACO}.*cleave\[draco\]"):
        read(asset.glb())


def test_damaged_data_gives_a_mesh_or_a_typed_error() -> None:
    asset, data = compressed()
    whole = asset.glb()
    at = whole.index(data)
    rng = np.random.default_rng(8)
    for _ in range(300):
        damaged = bytearray(whole)
        for place in rng.integers(0, len(data), 3):
            damaged[at + place] = rng.integers(256)
        read_or_none(bytes(damaged))
    with pytest.raises(InvalidMesh, match=f"The data of {DRACO}"):
        read(whole[:at] + bytes(len(data)) + whole[at + len(data) :])
