"""glTF with meshoptimizer's codecs: exactly what its reference encoder was given."""

import base64
import json
from pathlib import Path

import numpy as np
import pytest
from gltf_files import Asset
from hypothesis import given
from hypothesis import strategies as st
from soups import read, read_or_none

from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits

SAMPLES = json.loads((Path(__file__).parent / "meshopt" / "samples.json").read_text())
ENCODED = {name: base64.b64decode(data) for name, data in SAMPLES["encoded"].items()}
POSITIONS = np.array(SAMPLES["positions"]).reshape(-1, 3)
FACES = np.array(SAMPLES["indices"]).reshape(-1, 3)


def compressed_view(asset: Asset, data: bytes, count: int, stride: int, extension: str, **more: str) -> int:
    """A buffer view whose bytes are in another one, compressed."""
    source = asset.document["bufferViews"][asset.view([(byte,) for byte in data], 5121)]
    entry = {"buffer": 0, "byteOffset": source["byteOffset"], "byteLength": len(data), "byteStride": stride}
    return asset.add(
        "bufferViews",
        {"buffer": 1, "byteLength": count * stride, "extensions": {extension: {**entry, "count": count, **more}}},
    )


def asset_of(
    positions: str = "positions_0", corners: str = "triangles", extension: str = "EXT_meshopt_compression", **more: str
) -> Asset:
    asset = Asset()
    mode = "TRIANGLES" if corners == "triangles" else "INDICES"
    views = [
        compressed_view(asset, ENCODED[positions], len(POSITIONS), 12, extension, mode="ATTRIBUTES", **more),
        compressed_view(asset, ENCODED[corners], FACES.size, 4, extension, mode=mode),
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


@pytest.mark.parametrize("extension", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
@pytest.mark.parametrize("positions", ["positions_0", "positions_1"])
@pytest.mark.parametrize("corners", ["triangles", "indices"])
def test_vertices_and_faces_are_those_that_were_compressed(positions: str, corners: str, extension: str) -> None:
    mesh = read(asset_of(positions, corners, extension).glb())
    assert mesh.vertices.tolist() == POSITIONS.tolist()
    if corners == "indices":
        assert mesh.faces.tolist() == FACES.tolist()
    else:  # the codec for triangles keeps their order and their sense, but may turn one round to begin elsewhere
        turned = [np.roll(FACES, k, axis=1) for k in range(3)]
        assert np.any([(mesh.faces == faces).all(axis=1) for faces in turned], axis=0).all()


def test_the_filter_for_exponents_is_undone() -> None:
    mesh = read(asset_of("exponential", filter="EXPONENTIAL").glb())
    np.testing.assert_allclose(mesh.vertices, POSITIONS, atol=2**-14 * np.abs(POSITIONS).max())


@pytest.mark.parametrize("shorts", ["shorts_0", "shorts_1"])
def test_quantized_positions_are_decoded(shorts: str) -> None:
    asset = asset_of()
    view = compressed_view(asset, ENCODED[shorts], len(POSITIONS), 8, "EXT_meshopt_compression", mode="ATTRIBUTES")
    asset.document["bufferViews"][view]["byteStride"] = 8
    asset.document["accessors"][0] |= {"bufferView": view, "componentType": 5123}
    asset.document["extensionsRequired"].append("KHR_mesh_quantization")
    assert read(asset.glb()).vertices.tolist() == np.reshape(SAMPLES["shorts"], (-1, 4))[:, :3].tolist()


def test_a_filter_without_use_for_positions_is_refused_by_name() -> None:
    with pytest.raises(UnsupportedFormat, match="'QUATERNION'"):
        read(asset_of(filter="QUATERNION").glb())


@pytest.mark.parametrize("name", ["positions_0", "positions_1", "triangles", "indices"])
def test_data_that_is_cut_short_is_never_read(name: str) -> None:
    asset = asset_of(**{"positions" if name.startswith("pos") else "corners": name})
    view = asset.document["bufferViews"][1 if name.startswith("pos") else 3]["extensions"]["EXT_meshopt_compression"]
    for length in range(0, len(ENCODED[name]), 7):
        view["byteLength"] = length
        with pytest.raises(InvalidMesh):
            read(asset.glb())


@given(st.sampled_from(["positions_0", "positions_1", "triangles", "indices"]), st.data())
def test_damaged_data_gives_a_mesh_or_a_typed_error(name: str, data: st.DataObject) -> None:
    whole = asset_of(**{"positions" if name.startswith("pos") else "corners": name}).glb()
    at = whole.index(ENCODED[name])
    damaged = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[at + data.draw(st.integers(0, len(ENCODED[name]) - 1))] = data.draw(st.integers(0, 255))
    read_or_none(bytes(damaged))


def test_counts_beyond_what_the_data_can_hold_are_refused_before_memory_is_taken() -> None:
    for view in (1, 3):
        for count in (10**7, 3 * 10**9):
            asset = asset_of()
            asset.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["count"] = count
            with pytest.raises((InvalidMesh, LimitExceeded)):
                read(asset.glb())
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes"):
        read(asset_of().glb(), limits=ReadLimits(max_uncompressed_bytes=1000))
