"""glTF with meshoptimizer's codecs: the mesh is exactly what the reference encoder was given."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.compressed_gltf import DECODED, ENCODED, FACES, POSITIONS, SAMPLES, compressed_view, meshopt_asset
from helpers.files.polygon_soups import read, read_or_none
from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits


@pytest.mark.parametrize("extension", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
@pytest.mark.parametrize("positions", ["positions_0", "positions_1"])
@pytest.mark.parametrize("corners", ["triangles", "indices"])
def test_vertices_and_faces_are_those_that_were_compressed(positions: str, corners: str, extension: str) -> None:
    mesh = read(meshopt_asset(positions, corners, extension).glb())
    assert mesh.vertices.tolist() == POSITIONS.tolist()
    if corners == "indices":
        assert mesh.faces.tolist() == FACES.tolist()
    else:  # the codec keeps the order and orientation of the triangles, but not their first corners
        turned = [np.roll(FACES, k, axis=1) for k in range(3)]
        assert np.any([(mesh.faces == faces).all(axis=1) for faces in turned], axis=0).all()


def test_the_filter_for_exponents_is_undone() -> None:
    mesh = read(meshopt_asset("exponential", filter="EXPONENTIAL").glb())
    np.testing.assert_allclose(mesh.vertices, POSITIONS, atol=2**-14 * np.abs(POSITIONS).max())


@pytest.mark.parametrize(("stride", "component", "largest"), [(4, 5120, 127), (8, 5122, 32767)])
def test_the_filter_for_normals_is_undone_as_by_the_reference_decoder(
    stride: int, component: int, largest: int
) -> None:
    name = f"octahedral_{stride}"
    asset = meshopt_asset()
    options = {"mode": "ATTRIBUTES", "filter": "OCTAHEDRAL"}
    view = compressed_view(asset, ENCODED[name], len(POSITIONS), stride, "EXT_meshopt_compression", **options)
    asset.document["bufferViews"][view]["byteStride"] = stride
    accessor = {"bufferView": view, "componentType": component, "normalized": True}
    normals = asset.add("accessors", accessor | {"type": "VEC3", "count": len(POSITIONS)})
    asset.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals
    asset.document["extensionsRequired"].append("KHR_mesh_quantization")
    decoded = np.frombuffer(DECODED[name], f"<i{stride // 4}").reshape(-1, 4)[:, :3] / largest
    given = np.reshape(SAMPLES["normals"], (-1, 4))[:, :3]
    ours = read(asset.glb(), appearance=True).appearance.normals
    np.testing.assert_allclose(ours, decoded / np.linalg.norm(decoded, axis=1)[:, None], atol=1.5 / largest)
    np.testing.assert_allclose(ours, given, atol=4 / largest)


def test_the_filter_for_exponents_gives_what_the_reference_decoder_gives() -> None:
    mesh = read(meshopt_asset("exponential", filter="EXPONENTIAL").glb())
    assert mesh.vertices.tolist() == np.frombuffer(DECODED["exponential"], "<f4").reshape(-1, 3).tolist()


@pytest.mark.parametrize("shorts", ["shorts_0", "shorts_1"])
def test_quantized_positions_are_decoded(shorts: str) -> None:
    asset = meshopt_asset()
    view = compressed_view(asset, ENCODED[shorts], len(POSITIONS), 8, "EXT_meshopt_compression", mode="ATTRIBUTES")
    asset.document["bufferViews"][view]["byteStride"] = 8
    asset.document["accessors"][0] |= {"bufferView": view, "componentType": 5123}
    asset.document["extensionsRequired"].append("KHR_mesh_quantization")
    assert read(asset.glb()).vertices.tolist() == np.reshape(SAMPLES["shorts"], (-1, 4))[:, :3].tolist()


def test_a_filter_that_is_not_for_positions_is_refused_by_name() -> None:
    with pytest.raises(UnsupportedFormat, match="'QUATERNION'"):
        read(meshopt_asset(filter="QUATERNION").glb())


@pytest.mark.parametrize("name", ["positions_0", "positions_1", "triangles", "indices"])
def test_data_that_is_cut_short_is_never_read(name: str) -> None:
    asset = meshopt_asset(**{"positions" if name.startswith("pos") else "corners": name})
    view = asset.document["bufferViews"][1 if name.startswith("pos") else 3]["extensions"]["EXT_meshopt_compression"]
    for length in range(0, len(ENCODED[name]), 7):
        view["byteLength"] = length
        with pytest.raises(InvalidMesh):
            read(asset.glb())


@given(st.sampled_from(["positions_0", "positions_1", "triangles", "indices"]), st.data())
def test_damaged_data_gives_a_mesh_or_a_typed_error(name: str, data: st.DataObject) -> None:
    whole = meshopt_asset(**{"positions" if name.startswith("pos") else "corners": name}).glb()
    at = whole.index(ENCODED[name])
    damaged = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[at + data.draw(st.integers(0, len(ENCODED[name]) - 1))] = data.draw(st.integers(0, 255))
    read_or_none(bytes(damaged))


def test_counts_beyond_what_the_data_can_hold_are_refused_before_memory_is_taken() -> None:
    for view in (1, 3):
        for count in (10**7, 3 * 10**9):
            asset = meshopt_asset()
            asset.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["count"] = count
            with pytest.raises((InvalidMesh, LimitExceeded)):
                read(asset.glb())
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes"):
        read(meshopt_asset().glb(), limits=ReadLimits(max_uncompressed_bytes=1000))
